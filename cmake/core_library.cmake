# One static library from all floors but the bindings: rayleaf::rayleaf, for C++ programs. The Python module links it and
# hides every symbol but its init function.
file(GLOB RAYLEAF_SOURCES CONFIGURE_DEPENDS core/*/*.cpp)
list(FILTER RAYLEAF_SOURCES EXCLUDE REGEX "core/python/")
list(REMOVE_ITEM RAYLEAF_SOURCES ${RAYLEAF_IMAGE_SOURCES})
add_library(rayleaf_core STATIC ${RAYLEAF_SOURCES} $<TARGET_OBJECTS:rayleaf_images>)
# Sources that Highway compiles for each kind of processor are alone in their translation unit.
foreach(source ${RAYLEAF_SOURCES})
  file(STRINGS ${source} lanes REGEX "HWY_TARGET_INCLUDE" LIMIT_COUNT 1)
  if(lanes)
    set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION TRUE)
  endif()
endforeach()
add_library(rayleaf::rayleaf ALIAS rayleaf_core)
set_target_properties(rayleaf_core PROPERTIES EXPORT_NAME rayleaf OUTPUT_NAME rayleaf)
target_include_directories(rayleaf_core PUBLIC $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/core>
                                               $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/rayleaf>)
# What an installed library links is found again by cmake/rayleaf-config.cmake.in.
target_link_libraries(rayleaf_core PUBLIC $<BUILD_INTERFACE:rayleaf_flags> Imath::Imath TBB::tbb
                      PRIVATE "$<BUILD_INTERFACE:${RAYLEAF_THIRD_PARTIES}>")
target_compile_features(rayleaf_core PUBLIC cxx_std_20)
target_compile_options(rayleaf_core INTERFACE $<INSTALL_INTERFACE:-ffp-contract=off>)
target_include_directories(rayleaf_core SYSTEM PRIVATE ${OPENSUBDIV_INCLUDES} ${OPENVDB_INCLUDES})
# OpenVDB's templates fill a compiler by themselves.
set_source_files_properties(core/geometry/vdb_file.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION TRUE)
set_source_files_properties(core/geometry/vdb_file.cpp core/trace/patch_lanes.cpp core/trace/surface_lanes.cpp
                            core/trace/wall_lanes.cpp PROPERTIES COMPILE_OPTIONS
                            "${RAYLEAF_CHECKS_BY_CALLS}")

install(TARGETS rayleaf_core EXPORT rayleaf-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY core/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rayleaf
        FILES_MATCHING PATTERN "*.h" PATTERN "*.def" PATTERN "python" EXCLUDE)
set(RAYLEAF_CMAKE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/rayleaf)
install(EXPORT rayleaf-targets NAMESPACE rayleaf:: DESTINATION ${RAYLEAF_CMAKE_FOLDER})
configure_package_config_file(cmake/rayleaf-config.cmake.in ${CMAKE_BINARY_DIR}/rayleaf-config.cmake
                              INSTALL_DESTINATION ${RAYLEAF_CMAKE_FOLDER})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/rayleaf-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/rayleaf-config.cmake ${CMAKE_BINARY_DIR}/rayleaf-config-version.cmake
        DESTINATION ${RAYLEAF_CMAKE_FOLDER})
