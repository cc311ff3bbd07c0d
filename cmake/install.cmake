# SPDX-License-Identifier: Apache-2.0
# What `make install` installs: headers, libraries, the command with its manual pages and
# completion, and what pkg-config and find_package(imukit) need.

include(CMakePackageConfigHelpers)
set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/imukit)

install(DIRECTORY schemas DESTINATION ${CMAKE_INSTALL_DATADIR}/imukit FILES_MATCHING PATTERN "*.json")
install(DIRECTORY include/imukit DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h")

# Archives and shared libraries are two export sets, because only the archives need the
# dependencies' own development packages.
set(archives imukit imukit-physics)
set(shared_libraries)
if(IMUKIT_IO)
  list(APPEND archives imukit-io)
endif()
foreach(archive ${archives})
  string(REPLACE "-" "_" name ${archive})
  set_target_properties(${archive} PROPERTIES EXPORT_NAME ${name}_static)
  if(IMUKIT_SHARED)
    list(APPEND shared_libraries ${archive}-shared)
    set_target_properties(${archive}-shared PROPERTIES EXPORT_NAME ${name})
  endif()
endforeach()
if(IMUKIT_SHARED)
  install(TARGETS ${shared_libraries} EXPORT imukit-shared
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT imukit-shared NAMESPACE imukit:: DESTINATION ${package_directory})
endif()
install(TARGETS ${archives} EXPORT imukit-static ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT imukit-static NAMESPACE imukit:: DESTINATION ${package_directory})

configure_package_config_file(cmake/imukit-config.cmake.in imukit-config.cmake
  INSTALL_DESTINATION ${package_directory} NO_SET_AND_CHECK_MACRO)
# Until 1.0 a change of the minor version may break users.
write_basic_package_version_file(imukit-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/imukit-config.cmake
        ${PROJECT_BINARY_DIR}/imukit-config-version.cmake DESTINATION ${package_directory})

# The prefix of a .pc file is found from its own place, so that the tree can be moved.
set(pkgconfig_directory ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_LIBDIR BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX}
           OUTPUT_VARIABLE pc_libdir)
file(RELATIVE_PATH pc_prefix ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
foreach(archive ${archives})
  configure_file(cmake/${archive}.pc.in ${archive}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${archive}.pc DESTINATION ${pkgconfig_directory})
endforeach()

if(TARGET imukit-command)
  install(TARGETS imukit-command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET imukit-mpi)
  install(TARGETS imukit-mpi RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET manuals)
  install(DIRECTORY ${manual_directory}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
  install(FILES ${manual_directory}/imukit.bash RENAME imukit
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
endif()
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
