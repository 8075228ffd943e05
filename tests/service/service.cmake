# The real program as a client sees it, a file of tests per subject; their controls; and the checks that it must survive.
foreach(part sessions lifecycle memory output catalogue equations stream watched routes ending command_line alike estimates check commands data_folder swapped restart recordings keys refusals starts portable openapi steering round_trip queries pressed_substeps elastic_substeps heavy concurrent manners control)
  add_test(NAME service.${part} COMMAND ${Python3_EXECUTABLE} -m unittest -v ${part}_test
           WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}/tests/service)
  set_tests_properties(service.${part} PROPERTIES LABELS service
                       ENVIRONMENT "TRUESTEP_BINARY=$<TARGET_FILE:truestep>;TRUESTEP_SANITIZE=${TRUESTEP_SANITIZE}")
endforeach()

# Two hundred clients that never read take most of a minute to be given up.
add_test(NAME service.silent COMMAND ${Python3_EXECUTABLE} -m unittest -v silent_test
         WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}/tests/service)
set_tests_properties(service.silent PROPERTIES LABELS "service;deep" ENVIRONMENT "TRUESTEP_BINARY=$<TARGET_FILE:truestep>")

# These measure the process's memory, or how soon a request is served while others compute: meaningless under sanitizers.
set_tests_properties(service.memory service.lifecycle service.keys PROPERTIES LABELS "service;measured")
# How soon a request is served is measured with nothing else on the machine.
set_tests_properties(service.lifecycle service.keys PROPERTIES RUN_SERIAL TRUE)

# check_service(NAME SCRIPT EXPECT ARGUMENT...): a script of the checks folder against the program itself, while it
# plays and streams a scene.
function(check_service name script expect)
  add_test(NAME service.program.${name}
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/service/run_check.py --script ${TRUESTEP_CHECKS_FOLDER}/${script} --play fountain
            --server "$<TARGET_FILE:truestep> serve --port 0 --log-level warn --data-dir ${CMAKE_BINARY_DIR}/check-data/${name}"
            --expect ${expect} -- ${ARGN})
  set_tests_properties(service.program.${name} PROPERTIES LABELS service)
endfunction()
check_service(http_torture http_torture.py "94 of 94" {url}/healthz)
check_service(ws_conformance ws_conformance.py "141 of 141" {stream} --strict --alive)
check_service(json_torture json_torture.py "147 of 147" {url}/v1/scenes/validate --strict-i)
check_service(json_torture_wrapped json_torture.py "145 of 145" {url}/v1/sessions --strict-i --wrap "{\"x\":|}")
check_service(ws_slow_consumer ws_slow_consumer.py "kept fraction" {stream} --pid {pid} --slow 20 --seconds 8)
check_service(conn_flood conn_flood.py "health failures: 0" {url}/healthz --n 2000 --pid {pid} --drip-limit 15)
set_tests_properties(service.program.conn_flood service.program.ws_slow_consumer PROPERTIES RUN_SERIAL TRUE)

# The disk's calls fail one by one: a few of them, and in `--deep` all.
add_library(faults SHARED ${CMAKE_CURRENT_LIST_DIR}/fixtures/faults.c)
target_link_libraries(faults PRIVATE ${CMAKE_DL_LIBS})
function(add_faults name tier)
  add_test(NAME service.${name}
           COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/service/faults.py $<TARGET_FILE:faults> ${ARGN})
  set_tests_properties(service.${name} PROPERTIES LABELS "service${tier}" ENVIRONMENT "TRUESTEP_BINARY=$<TARGET_FILE:truestep>")
endfunction()
# What is preloaded below a sanitizer's own runtime is refused by it.
if(NOT TRUESTEP_SANITIZE)
  add_faults(faults "" --every 37)
  foreach(offset RANGE 0 5)
    add_faults(faults_all_${offset} ";deep" --every 6 --offset ${offset})
  endforeach()
endif()
