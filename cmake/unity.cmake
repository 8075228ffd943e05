# join_sources(TARGET BATCH FOLDER...): compiles the files of each folder BATCH at a time, so that the headers that they share
# are read once: half of what most files take. Apart stay files whose names in anonymous namespaces are those of a file beside
# them, those that tests make exceptions for, those with flags of their own, and the loops of steps: gcc inlines a function of
# any size where a file calls it once, and calls it where five joined files call it five times (rods took half as long again,
# bodies in space an eighth). Under sanitizers nobody counts that.
set(joined_apart
    # names of others
    export_vtu.cc recording_commands.cc saved_session.cc session_folder.cc osmesa_context.cc flocking_def.cc crowd_observe.cc
    msh_sections.cc obj.cc mercurius.cc solver_pack.cc heightfield_wave.cc heightfield_observe.cc mesh_ewald.cc contact.cc
    liquid.cc linear_tree.cc skeleton_observe.cc hull_faces.cc ply.cc method_search.cc work_precision.cc bdf2.cc rosenbrock.cc radau5.cc implicit_dense.cc joint_build.cc joint_def.cc sph_def.cc
    # exceptions of tests
    step_work.cc mass_spring_cost.cc fem_outputs.cc ode_compiler_axes.cc dense_lu.cc band_lu.cc sparse_lu_eigen.cc
    # flags of their own
    avx512_loops.cc plain_loops.cc choice.cc tree_newton.cc skeleton_lead.cc multigrid.cc version.cc sparse_lu.cc engines.cc parallel.cc thread_team.cc boost_sources.cc)
set(joined_loops "^(collision|integrators|kernels|lattice|math|neighbours|rigid|systems)")
set(joined_no_loops "_(build|check|checks|commands|cost|def|drawing|model|names|observe|output|outputs|state|tables|texts)\\.cc$|^rows_")
# Under sanitizers a third of the compiler's time in these folders went into asking of every access whether its pointer is null,
# aligned, within its object and of its type. What is read or written through a null or wild pointer meets the address sanitizer
# as well; the other folders, where objects are handed on and cast, ask it all.
set(joined_accesses "^(collision|integrators|kernels|lattice|math/solvers|neighbours|rigid|systems)")
set(access_options "")
if(TRUESTEP_SANITIZE)
  set(joined_loops "^$")
endif()
if(TRUESTEP_SANITIZE MATCHES "address.*undefined")
  set(access_options -fno-sanitize=null,alignment,vptr,object-size,pointer-overflow)
endif()
# What reads, writes and tells rather than computes: less inlining is a third of the compiler's time and nobody's.
set(joined_quick "^(api|cli|core/def|net/access|operations|persistence|scene|session/snapshot|sessions|sinks/recording|studies)")
set(quick_options $<$<CONFIG:Release>:-O1> $<$<CONFIG:Release>:-finline-small-functions>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Of strings that are put together or moved: gcc 12 warns of what is not there.
  list(APPEND quick_options -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
endif()
function(join_sources target batch)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  foreach(folder ${ARGN})
    file(GLOB files RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cc)
    set(n 0)
    foreach(file ${files})
      get_filename_component(name ${file} NAME)
      if(NOT name IN_LIST joined_apart AND (NOT folder MATCHES "${joined_loops}" OR name MATCHES "${joined_no_loops}"))
        math(EXPR group "${n} / ${batch}")
        string(REPLACE "/" "_" group ${folder}_${group})
        set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${group})
        # Options of joined files are those of what joins them.
        set(file ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/Unity/unity_${group}_cxx.cxx)
        math(EXPR n "${n} + 1")
      endif()
      get_source_file_property(options ${file} COMPILE_OPTIONS)
      if((folder MATCHES "${joined_quick}" OR (folder MATCHES "${joined_loops}" AND name MATCHES "${joined_no_loops}"))
         AND NOT options MATCHES "finline" AND NOT name IN_LIST joined_apart)
        set_property(SOURCE ${file} APPEND PROPERTY COMPILE_OPTIONS ${quick_options})
        get_source_file_property(options ${file} COMPILE_OPTIONS)
      endif()
      if(access_options AND folder MATCHES "${joined_accesses}" AND NOT options MATCHES "${access_options}")
        set_property(SOURCE ${file} APPEND PROPERTY COMPILE_OPTIONS ${access_options})
      endif()
    endforeach()
  endforeach()
endfunction()
