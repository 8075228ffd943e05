# What `cmake --install` and `cpack` take out of a build, in two components:
#   program   /usr/bin/truestep with its man page and licences; `cpack -G DEB` makes the Debian package of it
#   library   headers, static libraries and a CMake package: find_package(truestep), then truestep::engine (docs/library.md)
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_files ${PROJECT_SOURCE_DIR}/cmake/package)

# --- program
install(TARGETS truestep RUNTIME COMPONENT program)
set(man_page ${CMAKE_CURRENT_BINARY_DIR}/package/truestep.1)
install(CODE "execute_process(COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:truestep> -DPAGE=${man_page} -DVERSION=${PROJECT_VERSION}
                                      -P ${package_files}/man_page.cmake COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program)
install(FILES ${man_page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${package_files}/copyright ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/NOTICE ${PROJECT_SOURCE_DIR}/CHANGELOG.md
        DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/truestep COMPONENT program)

# --- library
set(truestep_headers ${CMAKE_INSTALL_INCLUDEDIR}/truestep)
set(truestep_package ${CMAKE_INSTALL_LIBDIR}/cmake/truestep)
foreach(part engine proto gallery)
  set_target_properties(truestep_${part} PROPERTIES EXPORT_NAME ${part})
  add_library(truestep::${part} ALIAS truestep_${part})
endforeach()
target_include_directories(truestep_engine INTERFACE $<INSTALL_INTERFACE:${truestep_headers}>)
target_include_directories(truestep_proto SYSTEM INTERFACE $<INSTALL_INTERFACE:${truestep_headers}>)
# Inline functions of the headers must be compiled as those in the library were: the same bits, and the same alignment of Eigen's types.
target_compile_features(truestep_engine INTERFACE cxx_std_20)
set(interface_options -ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND interface_options -march=x86-64-v3 -mtune=generic)
endif()
target_compile_options(truestep_engine INTERFACE "$<INSTALL_INTERFACE:${interface_options}>")

install(TARGETS truestep_engine truestep_proto truestep_gallery EXPORT truestepTargets ARCHIVE COMPONENT library)
install(EXPORT truestepTargets NAMESPACE truestep:: DESTINATION ${truestep_package} COMPONENT library)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/engine DESTINATION ${truestep_headers} COMPONENT library
        FILES_MATCHING PATTERN "*.h" PATTERN pch.h EXCLUDE)
install(DIRECTORY ${CMAKE_BINARY_DIR}/proto/truestep DESTINATION ${truestep_headers} COMPONENT library
        FILES_MATCHING PATTERN "*.pb.h")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes ${PROJECT_SOURCE_DIR}/proto DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/truestep
        COMPONENT library FILES_MATCHING PATTERN "*.json" PATTERN "*.proto")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/NOTICE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/truestep-dev
        COMPONENT library)
configure_package_config_file(${package_files}/truestepConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/package/truestepConfig.cmake
                              INSTALL_DESTINATION ${truestep_package})
# Before 1.0 a minor version may change the headers.
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/package/truestepConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/package/truestepConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/package/truestepConfigVersion.cmake
        DESTINATION ${truestep_package} COMPONENT library)

# --- Debian package of the program: it depends on what the section [runtime] of the package list names.
file(STRINGS ${PROJECT_SOURCE_DIR}/cmake/apt-packages.txt lines)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/apt-packages.txt)
set(section "")
set(depends "")
foreach(line ${lines})
  if(line MATCHES "^\\[?([a-z]+)\\]$")
    set(section ${CMAKE_MATCH_1})
  elseif(section STREQUAL "runtime" AND line MATCHES "^[a-z0-9]")
    list(APPEND depends ${line})
  endif()
endforeach()
list(JOIN depends ", " depends)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Truestep authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME truestep)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "physics simulation service")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "Truestep steps scenes of particles, springs, bodies, liquids and fields,
streams, records and draws their states, and says how accurate they are. One
program holds the engine, the HTTP and WebSocket server, the browser viewer and
the command line.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "${depends}")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS ffmpeg)
include(CPack)
