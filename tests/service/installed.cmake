# What `cmake --install` and `cpack` hand out, used as a stranger would. Not of sanitized builds, which nobody installs.
if(TRUESTEP_SANITIZE)
  return()
endif()
find_package(Python3 REQUIRED COMPONENTS Interpreter)
foreach(case Library Program DebianPackage)
  add_test(NAME service.installed.${case}
           COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/installed_test.py ${CMAKE_BINARY_DIR} -v ${case})
  set_tests_properties(service.installed.${case} PROPERTIES LABELS service)
endforeach()
