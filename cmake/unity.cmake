# join_sources(BATCH FOLDER...): compiles the files of each folder BATCH at a time, so that the headers that they share are
# read once. For code that no step runs: files of steps stay apart, because tests look at their objects one by one. The
# tree of the fuzz targets, which is only ever built whole, joins more. Names in anonymous namespaces of joined files must
# differ; APART names the files of which that is not so.
set(joined_apart dense_lu.cc export_vtu.cc)
function(join_sources target batch)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  foreach(folder ${ARGN})
    file(GLOB files RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cc)
    set(n 0)
    foreach(file ${files})
      get_filename_component(name ${file} NAME)
      if(NOT name IN_LIST joined_apart)
        math(EXPR group "${n} / ${batch}")
        string(REPLACE "/" "_" group ${folder}_${group})
        set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${group})
        math(EXPR n "${n} + 1")
      endif()
    endforeach()
  endforeach()
endfunction()
