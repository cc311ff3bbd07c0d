# SPDX-License-Identifier: Apache-2.0
# One program per file bench/bench_*.c; target `benchmarks`, run by tools/run_bench.
#
# bench/*.cpp are yardsticks: what one would write without this library, compiled to run as fast as
# it can on this machine. They never become part of the library.

add_custom_target(benchmarks)
set(benchmark_directory ${PROJECT_BINARY_DIR}/bench)
file(GLOB bench_sources CONFIGURE_DEPENDS bench/bench_*.c)
foreach(source ${bench_sources})
  get_filename_component(name ${source} NAME_WE)
  add_executable(${name} EXCLUDE_FROM_ALL ${source})
  target_include_directories(${name} PRIVATE src bench)
  target_link_libraries(${name} PRIVATE imukit-io ZLIB::ZLIB m)
  target_compile_definitions(${name} PRIVATE
    SOURCE_DIRECTORY="${PROJECT_SOURCE_DIR}"
    SHARED_DIRECTORY="${PROJECT_SOURCE_DIR}/../shared"
    BENCH_DIRECTORY="${benchmark_directory}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${benchmark_directory})
  add_dependencies(benchmarks ${name})
endforeach()

# The yardstick of the instruments is CVODE of SUNDIALS, where it is installed. The equations it is
# given are compiled to run as fast as they can on this machine.
if(TARGET bench_physics)
  find_path(IMUKIT_SUNDIALS_INCLUDE cvode/cvode.h)
  find_library(IMUKIT_SUNDIALS_CVODE sundials_cvode)
  find_library(IMUKIT_SUNDIALS_NVECTOR sundials_nvecserial)
  mark_as_advanced(IMUKIT_SUNDIALS_INCLUDE IMUKIT_SUNDIALS_CVODE IMUKIT_SUNDIALS_NVECTOR)
  target_sources(bench_physics PRIVATE bench/ode_yardstick.c bench/instrument_equations.c)
  set_source_files_properties(bench/ode_yardstick.c bench/instrument_equations.c PROPERTIES
    COMPILE_OPTIONS "-O3;-march=native;-ffp-contract=fast")
  if(IMUKIT_SUNDIALS_INCLUDE AND IMUKIT_SUNDIALS_CVODE AND IMUKIT_SUNDIALS_NVECTOR)
    target_compile_definitions(bench_physics PRIVATE BENCH_SUNDIALS)
    target_include_directories(bench_physics SYSTEM PRIVATE ${IMUKIT_SUNDIALS_INCLUDE})
    target_link_libraries(bench_physics PRIVATE
      ${IMUKIT_SUNDIALS_CVODE} ${IMUKIT_SUNDIALS_NVECTOR})
  endif()
endif()

# The yardstick of the mechanisation, compiled likewise; the drive is that of the tests.
if(TARGET bench_navigate)
  target_sources(bench_navigate PRIVATE bench/textbook_ned.c)
  target_include_directories(bench_navigate PRIVATE tests)
  set_source_files_properties(bench/textbook_ned.c PROPERTIES
    COMPILE_OPTIONS "-O3;-march=native;-ffp-contract=fast")
endif()

# Shards and ranks are processes of the command.
if(TARGET bench_drift)
  target_include_directories(bench_drift PRIVATE tests)
  target_compile_definitions(bench_drift PRIVATE
    IMUKIT_COMMAND="${PROJECT_BINARY_DIR}/imukit")
  foreach(command imukit-command imukit-mpi)
    if(TARGET ${command})
      add_dependencies(bench_drift ${command})
    endif()
  endforeach()
endif()

# The command as a whole process.
if(TARGET bench_identify AND TARGET imukit-command)
  target_compile_definitions(bench_identify PRIVATE IMUKIT_COMMAND="$<TARGET_FILE:imukit-command>")
  add_dependencies(bench_identify imukit-command)
endif()

file(GLOB yardstick_sources CONFIGURE_DEPENDS bench/*.cpp)
find_program(IMUKIT_CXX NAMES c++ g++ clang++)
if(yardstick_sources AND IMUKIT_CXX)
  foreach(source ${yardstick_sources})
    get_filename_component(name ${source} NAME_WE)
    add_custom_command(OUTPUT ${benchmark_directory}/${name}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${benchmark_directory}
      COMMAND ${IMUKIT_CXX} -O3 -march=native -o ${benchmark_directory}/${name} ${source}
      DEPENDS ${source} VERBATIM)
    add_custom_target(yardstick-${name} DEPENDS ${benchmark_directory}/${name})
    add_dependencies(benchmarks yardstick-${name})
  endforeach()
endif()

# Long statistical experiments, one program per file experiments/*.c; target `experiments`.
add_custom_target(experiments)
file(GLOB experiment_sources CONFIGURE_DEPENDS experiments/*.c)
foreach(source ${experiment_sources})
  get_filename_component(name ${source} NAME_WE)
  add_executable(${name} EXCLUDE_FROM_ALL ${source})
  target_link_libraries(${name} PRIVATE imukit-io m)
  set_target_properties(${name} PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/experiments)
  add_dependencies(experiments ${name})
endforeach()
