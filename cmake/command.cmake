# SPDX-License-Identifier: Apache-2.0
# The command `imukit`, and the manual pages and shell completion it writes about itself.

file(GLOB_RECURSE cli_sources CONFIGURE_DEPENDS cli/*.c)
if(NOT cli_sources)
  return()
endif()
# How campaigns are run is in two files: on threads, and on the ranks of MPI.
list(FILTER cli_sources EXCLUDE REGEX "/campaign_run(_mpi)?\\.c$")
add_library(imukit-command-objects OBJECT ${cli_sources})
target_include_directories(imukit-command-objects PRIVATE cli)
target_link_libraries(imukit-command-objects PRIVATE imukit-io)
target_compile_options(imukit-command-objects PRIVATE ${imukit_seldom_run})
add_executable(imukit-command $<TARGET_OBJECTS:imukit-command-objects> cli/campaign/campaign_run.c)
target_include_directories(imukit-command PRIVATE cli)
set_target_properties(imukit-command PROPERTIES OUTPUT_NAME imukit)
target_link_libraries(imukit-command PRIVATE imukit-io m)

# The verbs for programs that run them, as the gateway of matlab/ does. From an archive the linker
# takes what is missing, and so neither main() nor cli/shell/voice.c, in whose place they have their own.
add_library(imukit-verbs STATIC EXCLUDE_FROM_ALL $<TARGET_OBJECTS:imukit-command-objects>
            cli/campaign/campaign_run.c)
target_include_directories(imukit-verbs PRIVATE cli)
target_link_libraries(imukit-verbs PUBLIC imukit-io)

# A compiler of MPI without its headers, as openmpi-bin alone is, stops find_package() with an error.
if(IMUKIT_MPI STREQUAL AUTO)
  find_program(imukit_mpi_compiler mpicc)
  mark_as_advanced(imukit_mpi_compiler)
  if(imukit_mpi_compiler)
    execute_process(COMMAND ${imukit_mpi_compiler} -fsyntax-only -include mpi.h -x c /dev/null
                    RESULT_VARIABLE without_headers OUTPUT_QUIET ERROR_QUIET)
  endif()
  if(imukit_mpi_compiler AND without_headers EQUAL 0)
    find_package(MPI QUIET COMPONENTS C)
  endif()
elseif(IMUKIT_MPI)
  find_package(MPI REQUIRED COMPONENTS C)
endif()
if(IMUKIT_MPI AND MPI_C_FOUND)
  add_executable(imukit-mpi $<TARGET_OBJECTS:imukit-command-objects> cli/campaign/campaign_run_mpi.c)
  target_include_directories(imukit-mpi PRIVATE cli)
  target_link_libraries(imukit-mpi PRIVATE imukit-io MPI::MPI_C m)
endif()

# They come from the option tables the parser reads, so they cannot disagree with it.
if(NOT CMAKE_CROSSCOMPILING)
  set(manual_directory ${PROJECT_BINARY_DIR}/manual)
  add_custom_command(OUTPUT ${manual_directory}/imukit.bash
    COMMAND ${CMAKE_COMMAND} -D COMMAND=$<TARGET_FILE:imukit-command> -D OUTPUT=${manual_directory}
            -P ${PROJECT_SOURCE_DIR}/cmake/write_manuals.cmake
    DEPENDS imukit-command cmake/write_manuals.cmake VERBATIM)
  add_custom_target(manuals ALL DEPENDS ${manual_directory}/imukit.bash)
endif()
