# SPDX-License-Identifier: Apache-2.0
# Asks the command for its manual pages and its bash completion:
#
#     cmake -D COMMAND=build/imukit -D OUTPUT=build/manual -P cmake/write_manuals.cmake
#
# OUTPUT gets man1/imukit.1, man1/imukit-VERB.1 for each verb that page lists, and imukit.bash.

function(ask result)
  execute_process(COMMAND ${COMMAND} help ${ARGN} OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

ask(page --man)
file(WRITE ${OUTPUT}/man1/imukit.1 "${page}")
string(REGEX MATCHALL "imukit\\\\-[a-z]+" verbs "${page}")
list(REMOVE_DUPLICATES verbs)
foreach(verb ${verbs})
  string(REGEX REPLACE "^imukit\\\\-" "" verb "${verb}")
  ask(page --man ${verb})
  file(WRITE ${OUTPUT}/man1/imukit-${verb}.1 "${page}")
endforeach()
ask(completion --completion bash)
file(WRITE ${OUTPUT}/imukit.bash "${completion}")
