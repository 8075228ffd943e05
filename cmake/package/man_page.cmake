# cmake -DPROGRAM=truestep -DPAGE=truestep.1 -DVERSION=... -P man_page.cmake: the man page, its commands as `truestep --help` lists them.
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE ".*\nSubcommands:\n" "" help "${help}")
string(REGEX REPLACE "  ([a-z]+)  +([^\n]*)" ".TP\n.B \\1\n\\2" COMMANDS "${help}")
string(STRIP "${COMMANDS}" COMMANDS)
configure_file(${CMAKE_CURRENT_LIST_DIR}/truestep.1.in ${PAGE} @ONLY)
