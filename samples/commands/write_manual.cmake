# cmake -DLIMN=<program> -DFOLDER=<folder> -P write_manual.cmake: FOLDER/man1/*.1 and FOLDER/limn.bash, .zsh and .fish.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/man1)
execute_process(COMMAND ${LIMN} man -o ${FOLDER}/man1 COMMAND_ERROR_IS_FATAL ANY)
foreach(shell bash zsh fish)
  execute_process(COMMAND ${LIMN} completion ${shell} OUTPUT_FILE ${FOLDER}/limn.${shell} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
