cmake_minimum_required(VERSION 3.25)
# Every source is as clang-format 14 writes it with .clang-format: cmake -DROOT=... -DFORMATTER=... -P format.cmake
file(GLOB_RECURSE files ${ROOT}/sdf/*.h ${ROOT}/sdf/*.cpp ${ROOT}/subdiv/*.h ${ROOT}/subdiv/*.cpp ${ROOT}/raymarch/*.h ${ROOT}/raymarch/*.cpp
  ${ROOT}/samples/*.h ${ROOT}/samples/*.cpp ${ROOT}/tests/*.h ${ROOT}/tests/*.cpp)
list(FILTER files EXCLUDE REGEX "/node_modules/")
execute_process(COMMAND ${FORMATTER} --dry-run -Werror ${files} RESULT_VARIABLE code ERROR_VARIABLE text)
if(NOT code EQUAL 0)
  string(REGEX MATCHALL "[^\n]+: error:" places "${text}")
  list(JOIN places "\n" places)
  message(FATAL_ERROR "not formatted; clang-format -i FILE mends it:\n${places}")
endif()
