# Recordings as other people's software reads them, and recorders that are killed or run out of disk.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
foreach(fixture record_loop record_read)
  add_executable(${fixture} ${CMAKE_CURRENT_LIST_DIR}/fixtures/${fixture}.cc)
  target_link_libraries(${fixture} PRIVATE truestep_engine)
endforeach()
