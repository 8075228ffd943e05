# Recordings as other people's software reads them, and recorders that are killed or run out of disk.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
foreach(fixture record_loop record_read)
  add_executable(${fixture} ${CMAKE_CURRENT_LIST_DIR}/fixtures/${fixture}.cc)
  target_link_libraries(${fixture} PRIVATE truestep_engine)
endforeach()
set(loop $<TARGET_FILE:record_loop>)
set(read $<TARGET_FILE:record_read>)

function(add_recording_test name)
  add_test(NAME service.recording_${name} COMMAND ${ARGN})
  set_tests_properties(service.recording_${name} PROPERTIES LABELS service)
endfunction()

# tests/requirements.txt, installed by `truestep test`.
set(venv_python ${PROJECT_SOURCE_DIR}/build/venv/bin/python)
foreach(case multi single grids h5md swmr export controls)
  add_recording_test(${case} ${venv_python} ${CMAKE_CURRENT_LIST_DIR}/recording_readers.py ${loop} ${read} ${case})
endforeach()
add_test(NAME service.recording_contents COMMAND ${venv_python} -m unittest -v recording_contents_test
         WORKING_DIRECTORY ${CMAKE_CURRENT_LIST_DIR})
set_tests_properties(service.recording_contents PROPERTIES LABELS service
                     ENVIRONMENT "TRUESTEP_BINARY=$<TARGET_FILE:truestep>")
add_recording_test(finalize_kills ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/recording_kills.py ${loop} ${read})

set(kill9 ${Python3_EXECUTABLE} ${TRUESTEP_CHECKS_FOLDER}/kill9_recording.py --sleep-max 0.1)
set(full ${Python3_EXECUTABLE} ${TRUESTEP_CHECKS_FOLDER}/disk_full_recording.py)
# Small frames (chunks of several) and big ones (a chunk each); the repaired file, too.
add_recording_test(kill9 ${kill9} --trials 200 --cmd "${loop} {file} 2000" --read "${read} {file}")
add_recording_test(kill9_big ${kill9} --trials 40 --cmd "${loop} {file} 20000" --read "${read} {file} recover")
add_recording_test(disk_full ${full} --cmd "${loop} {file} 100" --read "${read} {file}")
add_recording_test(disk_full_big ${full} --cmd "${loop} {file} 5000" --read "${read} {file} recover")
# Controls: frames that were only handed over are lost, and the checks say so.
add_recording_test(kill9_control ${kill9} --trials 40 --cmd "${loop} {file} 20000 0 both appended" --read "${read} {file}")
add_recording_test(disk_full_control ${full} --cmd "${loop} {file} 100 0 both appended" --read "${read} {file}")
set_tests_properties(service.recording_kill9_control service.recording_disk_full_control PROPERTIES WILL_FAIL ON)
# Mounting the small disk needs root; the unit tests limit the file's size instead. Nothing else is skipped.
set_tests_properties(service.recording_disk_full service.recording_disk_full_big
                     PROPERTIES SKIP_REGULAR_EXPRESSION "cannot run: no tmpfs mount")
