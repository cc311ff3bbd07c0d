# SPDX-License-Identifier: Apache-2.0
# libimukit (the core: libm only), libimukit-physics (the instruments, on it) and libimukit-io (files,
# threads, reports).
#
# Each is compiled once, as position-independent objects, and made into an archive and a shared
# library.

file(GLOB_RECURSE core_sources CONFIGURE_DEPENDS src/base/*.c src/model/*.c src/noise/*.c
     src/motion/*.c src/simulate/*.c src/identify/*.c src/compensate/*.c src/calibrate/*.c
     src/navigate/*.c)
file(GLOB_RECURSE physics_sources CONFIGURE_DEPENDS src/physics/*.c)
file(GLOB_RECURSE io_sources CONFIGURE_DEPENDS src/jobs/*.c src/report/*.c src/io/*.c)
set(IMUKIT_FILE_FILTER "" CACHE STRING "Regular expression: build only files of such names")
list(FILTER core_sources INCLUDE REGEX "/(${IMUKIT_FILE_FILTER})[^/]*$")
list(FILTER physics_sources INCLUDE REGEX "/(${IMUKIT_FILE_FILTER})[^/]*$")
if(NOT physics_sources) # a library has a file
  set(physics_sources src/physics/draws.c)
endif()
list(FILTER io_sources INCLUDE REGEX "/(${IMUKIT_FILE_FILTER})[^/]*$")
set(page_assets ${PROJECT_BINARY_DIR}/page_assets.c)
file(GLOB page_parts CONFIGURE_DEPENDS src/report/page/*.js)
add_custom_command(
  OUTPUT ${page_assets}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${page_assets}
          -P ${PROJECT_SOURCE_DIR}/cmake/write_page_assets.cmake
  DEPENDS cmake/write_page_assets.cmake ${page_parts} src/report/page/page_style.css)
list(APPEND io_sources ${page_assets})

# One file per instruction set, chosen at run time; the rest is compiled for the base machine.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set_source_files_properties(src/base/random/normals_avx2.c src/motion/trajectory_avx2.c PROPERTIES
                              COMPILE_OPTIONS "-mavx2")
  set_source_files_properties(src/navigate/strapdown/strapdown_block_fma.c PROPERTIES COMPILE_OPTIONS
                              "-mfma")
  set_source_files_properties(src/navigate/strapdown/strapdown_block_avx2.c PROPERTIES COMPILE_OPTIONS
                              "-mavx2;-mfma")
  set_source_files_properties(src/base/random/normals_avx512.c src/motion/trajectory_avx512.c
                              src/navigate/strapdown/strapdown_block_avx512.c PROPERTIES
                              COMPILE_OPTIONS "-mavx512f;-mavx512dq")
endif()

# With sanitizers clang takes minutes for each of the unrolled kernels, which read no strangers' bytes.
if(IMUKIT_FUZZ)
  set(kernel_sources ${core_sources})
  list(FILTER kernel_sources INCLUDE REGEX "_(scalar|portable|avx2|avx512|fma|neon)\\.c$")
  set_property(SOURCE ${kernel_sources} APPEND PROPERTY COMPILE_OPTIONS "-fno-sanitize=all")
endif()

# With sanitizers, and all of a trajectory inlined at each of its nodes, gcc takes ten times as long.
if(IMUKIT_SANITIZE)
  set_property(SOURCE src/motion/trajectory_portable.c src/motion/trajectory_avx2.c
               src/motion/trajectory_avx512.c APPEND PROPERTY COMPILE_DEFINITIONS KERNEL=static)
endif()

# With sanitizers, half of the tests' time is in these: optimised, they are a
# third to three times as fast. The others run so little that optimising them takes longer.
if(IMUKIT_SANITIZE AND NOT IMUKIT_FUZZ)
  set(much_run
      alignment_whitener allan_covariance allan_covariance_terms allan_edf allan_gaps_point
      allan_gaps_type allan_type allan_variance arma attitude attitude_jet bluestein
      calibration_freedom calibration_information calibration_normal calibration_regressors
      calibration_rows calibration_turn cholesky coarse_ranges decimal_format decimal_parse distort
      distort_portable drift_aid_sources drift_columns drift_feedback drift_propagate drift_radius
      drift_steps elementary fast_shape filtered_white flicker free_gyro_dynamics identify_lines
      joint_shape least_squares level_jumps level_noise linear_dynamics linear_system log_coherence
      magnetometer magnetometer_equations mems_accelerometer_sigma_delta navigation_filter_predict
      navigation_filter_update noise_strength normal_distribution normals_avx2 normals_avx512
      normals_scalar output_filter pendulous_servo_dynamics plan_make reference_fit reference_offset
      resonance ring_laser_dynamics roots_of_unity screen_finish screen_trend screener_cycles
      screener_moments screener_serial sinusoids smooth_transform sort spectral_fit spectral_lines
      spectral_shape spectrum_parameters spectrum_slepian static_summary stockham
      suspended_rotor_cavity suspended_rotor_dynamics thermal_blocks thermal_noise tuning_fit
      tuning_fork_frame tuning_noise units vector_matrix vibrating_beam_derived)
  list(JOIN much_run "|" much_run)
  set(seldom_run_sources ${core_sources} ${physics_sources} ${io_sources})
  list(FILTER seldom_run_sources EXCLUDE REGEX "/((${much_run})\\.c$|(log_|npy|input_))")
  set_property(SOURCE ${seldom_run_sources} APPEND PROPERTY COMPILE_OPTIONS ${imukit_seldom_run})
  set(much_run_sources ${core_sources} ${physics_sources})
  list(FILTER much_run_sources INCLUDE REGEX "/(${much_run})\\.c$")
  set_property(SOURCE ${much_run_sources} APPEND PROPERTY COMPILE_OPTIONS -O3)
endif()

set(imukit_soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

# imukit_library(NAME SOURCES <file>... OURS <library>... PUBLIC <library>... PRIVATE <library>...)
# makes NAME (archive) and, when asked for, NAME-shared. OURS are libraries made here before: the
# archive needs theirs, the shared library their shared one.
#
# A shared library shows its public functions only, yet the others use internals of the core (tables
# of the model's fields and of units, linear systems). So they take the few objects that hold those
# from the archive and keep them to themselves; the core has no writable data, so two copies cannot disagree.
function(imukit_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;OURS;PUBLIC;PRIVATE")
  add_library(${name}-objects OBJECT ${arg_SOURCES})
  target_include_directories(${name}-objects PRIVATE ${PROJECT_SOURCE_DIR}/include
                             ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(${name}-objects PRIVATE ${arg_PRIVATE})

  add_library(${name} STATIC $<TARGET_OBJECTS:${name}-objects>)
  target_link_libraries(${name} PUBLIC ${arg_OURS} ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  set(targets ${name})
  if(IMUKIT_SHARED)
    set(shared ${name}-shared)
    list(APPEND targets ${shared})
    list(TRANSFORM arg_OURS APPEND -shared OUTPUT_VARIABLE ours_shared)
    add_library(${shared} SHARED $<TARGET_OBJECTS:${name}-objects>)
    target_link_libraries(${shared} PUBLIC ${ours_shared} ${arg_PUBLIC}
                          PRIVATE ${arg_OURS} ${arg_PRIVATE})
    set_target_properties(${shared} PROPERTIES VERSION ${PROJECT_VERSION}
                          SOVERSION ${imukit_soversion})
    # Installed side by side, wherever that is.
    if(arg_OURS AND APPLE)
      set_target_properties(${shared} PROPERTIES INSTALL_RPATH "@loader_path")
    elseif(arg_OURS)
      set_target_properties(${shared} PROPERTIES INSTALL_RPATH "$ORIGIN")
    endif()
    if(NOT APPLE)
      target_link_options(${shared} PRIVATE -Wl,--exclude-libs,ALL)
      if(NOT IMUKIT_SANITIZE)
        target_link_options(${shared} PRIVATE -Wl,-z,defs)
      endif()
    endif()
  endif()
  foreach(target ${targets})
    target_include_directories(${target} PUBLIC
      $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
    set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name} LINKER_LANGUAGE C)
  endforeach()
endfunction()

imukit_library(imukit SOURCES ${core_sources} PUBLIC m)
imukit_library(imukit-physics SOURCES ${physics_sources} OURS imukit PUBLIC m)

if(IMUKIT_IO)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(yaml REQUIRED IMPORTED_TARGET yaml-0.1)
  pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
  pkg_check_modules(expat REQUIRED IMPORTED_TARGET expat)
  pkg_check_modules(lz4 REQUIRED IMPORTED_TARGET liblz4)
  pkg_check_modules(sqlite REQUIRED IMPORTED_TARGET sqlite3)
  find_package(BZip2 REQUIRED)
  # Its serial form, where that has a name of its own.
  pkg_search_module(hdf5 REQUIRED IMPORTED_TARGET hdf5-serial>=1.10.2 hdf5>=1.10.2)
  # Its shared library brings thirty others, of networks and cryptography, none of them used here. So
  # programs take what they need from its archive, where there is one, and start in 2.5 ms, not 8.6.
  find_library(IMUKIT_HDF5_ARCHIVE NAMES libhdf5.a PATHS ${hdf5_LIBRARY_DIRS} NO_DEFAULT_PATH)
  mark_as_advanced(IMUKIT_HDF5_ARCHIVE)
  include(CheckCSourceCompiles)
  set(CMAKE_REQUIRED_INCLUDES ${hdf5_INCLUDE_DIRS})
  set(CMAKE_REQUIRED_LIBRARIES ${IMUKIT_HDF5_ARCHIVE} sz z m dl)
  check_c_source_compiles("#include <hdf5.h>
    int main(void) { return H5open() || H5Fopen(\"/dev/null\", 0, H5P_DEFAULT) < 0; }" IMUKIT_HDF5_ARCHIVE_LINKS)
  unset(CMAKE_REQUIRED_INCLUDES)
  unset(CMAKE_REQUIRED_LIBRARIES)
  if(IMUKIT_HDF5_ARCHIVE_LINKS)
    set_property(TARGET PkgConfig::hdf5 PROPERTY INTERFACE_LINK_LIBRARIES
      "$<IF:$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>,${IMUKIT_HDF5_ARCHIVE};sz;z;dl,${hdf5_LINK_LIBRARIES}>")
  endif()
  find_package(ZLIB REQUIRED)
  find_package(Threads REQUIRED)
  imukit_library(imukit-io SOURCES ${io_sources} OURS imukit-physics imukit
                 PRIVATE PkgConfig::yaml PkgConfig::zstd PkgConfig::expat PkgConfig::hdf5
                         PkgConfig::lz4 PkgConfig::sqlite BZip2::BZip2 ZLIB::ZLIB Threads::Threads)
endif()

# The names users of the installed package see, valid within this tree as well.
if(IMUKIT_SHARED)
  add_library(imukit::imukit ALIAS imukit-shared)
  add_library(imukit::imukit_physics ALIAS imukit-physics-shared)
else()
  add_library(imukit::imukit ALIAS imukit)
  add_library(imukit::imukit_physics ALIAS imukit-physics)
endif()
if(IMUKIT_IO AND IMUKIT_SHARED)
  add_library(imukit::imukit_io ALIAS imukit-io-shared)
elseif(IMUKIT_IO)
  add_library(imukit::imukit_io ALIAS imukit-io)
endif()
