# The README's commands, run as written, against this build; they build whatever is not built, which nobody does under sanitizers.
if(TRUESTEP_SANITIZE)
  return()
endif()
find_package(Python3 REQUIRED COMPONENTS Interpreter)
get_filename_component(preset ${CMAKE_BINARY_DIR} NAME)
add_test(NAME service.readme COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/readme_test.py)
set_tests_properties(service.readme PROPERTIES LABELS "service;default" ENVIRONMENT TRUESTEP_PRESET=${preset})

# All JSON of the README and of docs/, in the scenes that stand beside it.
add_test(NAME service.documented_json COMMAND ${Python3_EXECUTABLE} -m unittest documented_json_test
         WORKING_DIRECTORY ${CMAKE_CURRENT_LIST_DIR})
set_tests_properties(service.documented_json PROPERTIES LABELS "service;default" ENVIRONMENT "TRUESTEP_BINARY=$<TARGET_FILE:truestep>")
