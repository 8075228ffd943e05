# Checks that talk to a running server. The fixture has all of server/net and none of the sessions.
find_package(Python3 REQUIRED COMPONENTS Interpreter)

add_executable(net_echo ${PROJECT_SOURCE_DIR}/tests/service/fixtures/net_echo.cc)
target_link_libraries(net_echo PRIVATE truestep_service)

# check(NAME SCRIPT EXPECT ARGUMENT...): runs a script of the checks folder against the fixture.
function(check name script expect)
  add_test(NAME service.net.${name}
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/service/run_check.py --script ${TRUESTEP_CHECKS_FOLDER}/${script}
            --server $<TARGET_FILE:net_echo> --expect ${expect} -- ${ARGN})
  set_tests_properties(service.net.${name} PROPERTIES LABELS service)
endfunction()

check(http_torture http_torture.py "94 of 94" {url}/healthz)
check(ws_conformance ws_conformance.py "141 of 141" {ws}/echo --strict --alive)
check(ws_conformance_echo ws_conformance.py "141 of 141" {ws}/echo --strict)
check(json_torture json_torture.py "147 of 147" {url}/json --strict-i)
check(json_torture_wrapped json_torture.py "of" {url}/json --strict-i --wrap "{\"x\":|}")
check(conn_flood conn_flood.py "health failures: 0" {url}/healthz --n 2000 --pid {pid} --drip-limit 15)
check(ws_slow_consumer ws_slow_consumer.py "kept fraction" {ws}/push --pid {pid} --slow 20 --keep 0.9)
# These two measure times and rates: alone on the machine.
set_tests_properties(service.net.conn_flood service.net.ws_slow_consumer PROPERTIES RUN_SERIAL TRUE)
