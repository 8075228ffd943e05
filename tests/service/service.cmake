# The real program as a client sees it, one test per class of service_test.py, and the checks that it must survive.
foreach(part Sessions Output Catalogue Stream Ending CommandLine)
  add_test(NAME service.${part} COMMAND ${Python3_EXECUTABLE} -m unittest -v service_test.${part}
           WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}/tests/service)
  set_tests_properties(service.${part} PROPERTIES LABELS service TIMEOUT 300
                       ENVIRONMENT "TRUESTEP_BINARY=$<TARGET_FILE:truestep>")
endforeach()
