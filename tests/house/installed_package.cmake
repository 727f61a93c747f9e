cmake_minimum_required(VERSION 3.25)
# `cmake --install` into an empty folder, then another project finds limn there, links it and runs.
#   cmake -DBUILD=<build folder> -DSOURCE=<consumer project> -DLINKER_FLAGS=<of the build> -P installed_package.cmake
set(work ${BUILD}/installed_package)
file(REMOVE_RECURSE ${work})
function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "failed (${code}): ${ARGN}\n${text}")
  endif()
endfunction()
step(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
# The component that the package limn is made of: the program with what it needs to run, and nothing that only a compiler reads.
step(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/program --component program)
foreach(file bin/limn libexec/limn/limn-read-mesh libexec/limn/limn-read-vdb libexec/limn/limn-read-picture libexec/limn/limn-read-svg libexec/limn/limn-pictures.so
    libexec/limn/limn-hash.so libexec/limn/limn-filters.so libexec/limn/limn-embree.so libexec/limn/limn-cairo.so libexec/limn/limn-volumes.so share/man/man1/limn.1 share/man/man1/limn-render.1 share/bash-completion/completions/limn
    share/fish/vendor_completions.d/limn.fish share/limn/workflow/Snakefile)
  if(NOT EXISTS ${work}/program/${file})
    message(FATAL_ERROR "the component program lacks ${file}")
  endif()
endforeach()
if(EXISTS ${work}/program/include OR EXISTS ${work}/program/lib)
  message(FATAL_ERROR "the component program has headers or libraries")
endif()
step(${CMAKE_COMMAND} -S ${SOURCE} -B ${work}/build -G Ninja -DCMAKE_PREFIX_PATH=${work}/prefix -DCMAKE_BUILD_TYPE=Release -DCMAKE_EXE_LINKER_FLAGS=${LINKER_FLAGS})
step(${CMAKE_COMMAND} --build ${work}/build)
step(${work}/build/consumer)
step(${work}/build/experiment)
step(${work}/build/border)
