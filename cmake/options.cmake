# Language, warnings and the floating-point rules that make results reproducible.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3")

option(TRUESTEP_WERROR "Warnings end the build (of gcc)" $ENV{TRUESTEP_WERROR})

# One hash on every machine: no contraction, no fast-math, the same baseline everywhere.
add_compile_options(-ffp-contract=off -fno-math-errno -fno-trapping-math -Wall -Wextra -Wno-unused-parameter)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # False alarms of gcc 12: on std::variant, members that have defaults, joined sources.
  add_compile_options(-Wno-maybe-uninitialized -Wno-missing-field-initializers -Wno-subobject-linkage)
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

# Paths below the source folder are hashed relative to it, so that every clone on a machine shares one cache.
find_program(TRUESTEP_CCACHE ccache)
if(TRUESTEP_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_PCH_EXTSUM=1
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${TRUESTEP_CCACHE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
    # Without -Xclang, so that ccache sees a path that it can make relative.
    set(CMAKE_CXX_COMPILE_OPTIONS_USE_PCH -include-pch <PCH_FILE>)
  else()
    add_compile_options(-fpch-preprocess)
  endif()
endif()

find_program(TRUESTEP_LLD ld.lld)
if(TRUESTEP_LLD)
  add_link_options(-fuse-ld=lld)
endif()

# precompile(TARGET HEADER): gcc's precompiled headers never come out the same twice and clang's hold the build folder's
# path, so what ccache hashes in their place is what they are made from. HEADER includes only what its packages bring,
# no header of ours.
function(precompile target header)
  target_precompile_headers(${target} PRIVATE <${header}>)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${header})
  file(SHA256 ${PROJECT_SOURCE_DIR}/${header} sum)
  set(suffix gch)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    set(suffix pch)
  endif()
  file(CONFIGURE OUTPUT CMakeFiles/${target}.dir/cmake_pch.hxx.${suffix}.sum
       CONTENT "${sum} ${CMAKE_CXX_COMPILER_VERSION} Boost ${Boost_VERSION} ${CMAKE_BUILD_TYPE} ${TRUESTEP_SANITIZE}\n" @ONLY)
endfunction()
