# cmake -DLIMN=<program> -DFOLDER=<folder> [-DCOMPRESS=ON] -P write_manual.cmake: FOLDER/man1/*.1 and FOLDER/limn.bash, .zsh and .fish.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/man1)
execute_process(COMMAND ${LIMN} man -o ${FOLDER}/man1 COMMAND_ERROR_IS_FATAL ANY)
foreach(shell bash zsh fish)
  execute_process(COMMAND ${LIMN} completion ${shell} OUTPUT_FILE ${FOLDER}/limn.${shell} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
# Debian's packages have them compressed, without the time at which that was.
if(COMPRESS)
  file(GLOB pages ${FOLDER}/man1/*.1)
  execute_process(COMMAND gzip -9 -n ${pages} COMMAND_ERROR_IS_FATAL ANY)
endif()
