# Language, warnings and the floating-point rules that make results reproducible.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
# Everything ends in executables. Code for shared libraries (-fPIC) could be replaced when it is loaded, so that gcc inlines no
# function that other files see: a tenth of what an HTTP request takes.
add_compile_options(-fPIE)
add_link_options(-pie)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
# Folders without the loops of steps say less (cmake/unity.cmake).
set(CMAKE_CXX_FLAGS_RELEASE "-O3")

option(TRUESTEP_WERROR "Warnings end the build (of gcc)" $ENV{TRUESTEP_WERROR})

# One hash on every machine: no contraction, no fast-math, the same baseline everywhere.
add_compile_options(-ffp-contract=off -fno-math-errno -fno-trapping-math -Wall -Wextra -Wno-unused-parameter)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # False alarms of gcc 12: on std::variant, members that have defaults, joined sources.
  add_compile_options(-Wno-maybe-uninitialized -Wno-missing-field-initializers
                      $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
  # Most files end before the compiler has used so much memory: collecting garbage until then costs an eighth of its time.
  add_compile_options("SHELL:--param ggc-min-heapsize=600000")
  if(TRUESTEP_WERROR)
    # Coroutines and vectors that grow: gcc 12 warns of what is not there.
    add_compile_options(-Werror -Wno-error=stringop-overflow -Wno-error=array-bounds -Wno-error=free-nonheap-object)
  endif()
  # gcc 12 makes vfmaddsub of a product and a sum here in spite of -ffp-contract=off (tests/determinism watches).
  add_compile_options(-fno-tree-slp-vectorize)
else()
  # `#pragma GCC ivdep` and `unroll` are gcc's: others find the same loops to be safe, or leave them.
  add_compile_options(-Wno-unknown-pragmas)
endif()
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-march=x86-64-v3 -mtune=generic)
endif()

set(TRUESTEP_SANITIZE "" CACHE STRING "Sanitizers, comma separated: address,undefined or thread")
if(TRUESTEP_SANITIZE)
  add_compile_options(-fsanitize=${TRUESTEP_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${TRUESTEP_SANITIZE})
endif()

# Paths below the source folder are hashed relative to it, so that every clone on a machine shares one cache. What a file includes
# is taken from the compiler's own list (CCACHE_DEPEND): nothing is preprocessed twice.
find_program(TRUESTEP_CCACHE ccache)
if(TRUESTEP_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER env
      CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_PCH_EXTSUM=1 CCACHE_DEPEND=1
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${TRUESTEP_CCACHE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
    # Without -Xclang, so that ccache sees a path that it can make relative.
    set(CMAKE_CXX_COMPILE_OPTIONS_USE_PCH -include-pch <PCH_FILE>)
  else()
    add_compile_options(-fpch-preprocess)
  endif()
endif()

option(TRUESTEP_BUILD_COST "Record the CPU seconds of every compiler in build_cost.tsv (docs/building.md)" OFF)
if(TRUESTEP_BUILD_COST)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/cmake/build_cost.py record
      ${CMAKE_BINARY_DIR}/build_cost.tsv ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

find_program(TRUESTEP_LLD ld.lld)
if(TRUESTEP_LLD)
  add_link_options(-fuse-ld=lld)
endif()

# headers_of(OUT HEADER): HEADER and every header of ours that it includes, as paths below the source folder.
function(headers_of out header)
  set(found ${header})
  set(unread ${header})
  while(unread)
    list(POP_FRONT unread next)
    file(STRINGS ${PROJECT_SOURCE_DIR}/${next} lines REGEX "^#include \"(engine|server)/")
    foreach(line ${lines})
      string(REGEX REPLACE "^#include \"([^\"]*)\".*" "\\1" name "${line}")
      if(NOT name IN_LIST found)
        list(APPEND found ${name})
        list(APPEND unread ${name})
      endif()
    endforeach()
  endwhile()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

# precompile(TARGET HEADER): gcc's precompiled headers never come out the same twice and clang's hold the build folder's
# path, so what ccache hashes in their place is what they are made from: the text of every header of ours, the versions of the
# packages that bring the others.
function(precompile target header)
  target_precompile_headers(${target} PRIVATE <${header}>)
  headers_of(headers ${header})
  set(sums "")
  foreach(name ${headers})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${name})
    file(SHA256 ${PROJECT_SOURCE_DIR}/${name} sum)
    string(APPEND sums ${sum})
  endforeach()
  string(SHA256 sum "${sums}")
  set(suffix gch)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    set(suffix pch)
  endif()
  file(CONFIGURE OUTPUT CMakeFiles/${target}.dir/cmake_pch.hxx.${suffix}.sum
       CONTENT "${sum} ${CMAKE_CXX_COMPILER_VERSION} Boost ${Boost_VERSION} ${CMAKE_BUILD_TYPE} ${TRUESTEP_SANITIZE}\n" @ONLY)
endfunction()
