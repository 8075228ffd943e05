# Studies as clients start them.
foreach(part Studies StudyCommand)
  add_test(NAME service.${part} COMMAND ${Python3_EXECUTABLE} -m unittest -v studies_test.${part}
           WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}/tests/service)
  set_tests_properties(service.${part} PROPERTIES LABELS service
                       ENVIRONMENT "TRUESTEP_BINARY=$<TARGET_FILE:truestep>")
endforeach()
