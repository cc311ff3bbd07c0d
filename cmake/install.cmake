# SPDX-License-Identifier: Apache-2.0
# What `make install` installs: headers, libraries, the command with its manual pages and
# completion, and what pkg-config and find_package(imukit) need.

include(CMakePackageConfigHelpers)
set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/imukit)

install(DIRECTORY include/imukit DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h")

# Archives and shared libraries are two export sets, because only the archives need the
# dependencies' own development packages.
set(archives imukit)
set(shared_libraries)
if(IMUKIT_IO)
  list(APPEND archives imukit-io)
endif()
if(IMUKIT_SHARED)
  list(TRANSFORM archives APPEND -shared OUTPUT_VARIABLE shared_libraries)
  set_target_properties(imukit-shared PROPERTIES EXPORT_NAME imukit)
  install(TARGETS imukit-shared EXPORT imukit-shared
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  if(IMUKIT_IO)
    set_target_properties(imukit-io-shared PROPERTIES EXPORT_NAME imukit_io)
    install(TARGETS imukit-io-shared EXPORT imukit-shared
            LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  endif()
  install(EXPORT imukit-shared NAMESPACE imukit:: DESTINATION ${package_directory})
endif()
set_target_properties(imukit PROPERTIES EXPORT_NAME imukit_static)
if(IMUKIT_IO)
  set_target_properties(imukit-io PROPERTIES EXPORT_NAME imukit_io_static)
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
configure_file(cmake/imukit.pc.in imukit.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/imukit.pc DESTINATION ${pkgconfig_directory})
if(IMUKIT_IO)
  configure_file(cmake/imukit-io.pc.in imukit-io.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/imukit-io.pc DESTINATION ${pkgconfig_directory})
endif()

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
