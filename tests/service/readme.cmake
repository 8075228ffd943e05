# The README's commands, run as written, against this build.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
get_filename_component(preset ${CMAKE_BINARY_DIR} NAME)
add_test(NAME service.readme COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/readme_test.py)
set_tests_properties(service.readme PROPERTIES LABELS service ENVIRONMENT TRUESTEP_PRESET=${preset})
