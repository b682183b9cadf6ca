# The Python module rayleaf._core, what it is measured against, and the folder that Blender loads both from.

# A module for the interpreter's Python, or for the one whose headers are given.
function(rayleaf_add_module name)
  if(NOT RAYLEAF_PYTHON_HEADERS)
    pybind11_add_module(${name} MODULE NO_EXTRAS ${ARGN})
    return()
  endif()
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE pybind11::headers)
  target_include_directories(${name} SYSTEM PRIVATE ${RAYLEAF_PYTHON_HEADERS}/include/python${RAYLEAF_PYTHON_VERSION}
                                                    ${RAYLEAF_PYTHON_HEADERS}/include)
  string(REPLACE "." "" tag "${RAYLEAF_PYTHON_VERSION}")
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX ".cpython-${tag}-x86_64-linux-gnu.so")
endfunction()

file(GLOB RAYLEAF_BINDINGS CONFIGURE_DEPENDS core/python/*.cpp)
rayleaf_add_module(_core ${RAYLEAF_BINDINGS})
target_link_libraries(_core PRIVATE rayleaf_core rayleaf_flags)
target_compile_options(_core PRIVATE ${RAYLEAF_CHECKS_BY_CALLS})
set_target_properties(_core PROPERTIES UNITY_BUILD_BATCH_SIZE 8)  # templates of pybind11 fill a compiler early
set_source_files_properties(core/python/module.cpp PROPERTIES COMPILE_DEFINITIONS
  "RAYLEAF_VERSION=\"${PROJECT_VERSION}\";RAYLEAF_COMPILER=\"${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}\";\
RAYLEAF_EMBREE_VERSION=\"${embree_VERSION}\";RAYLEAF_OPENIMAGEIO_VERSION=\"${OPENIMAGEIO_VERSION}\";\
RAYLEAF_OPENSUBDIV_VERSION=\"${OPENSUBDIV_VERSION}\";RAYLEAF_OPENVDB_VERSION=\"${OPENVDB_VERSION}\";RAYLEAF_TBB_VERSION=\"${TBB_VERSION}\"")
target_link_options(_core PRIVATE -Wl,--exclude-libs,ALL -Wl,--version-script=${CMAKE_SOURCE_DIR}/core/python/exports.map)
set_target_properties(_core PROPERTIES LINK_DEPENDS ${CMAKE_SOURCE_DIR}/core/python/exports.map)

# What tests and benchmarks measure the core against, as a Python module of its own. No package holds it.
file(GLOB RAYLEAF_RIVALS CONFIGURE_DEPENDS rivals/*.cpp)
rayleaf_add_module(rayleaf_rivals EXCLUDE_FROM_ALL ${RAYLEAF_RIVALS} core/python/arrays.cpp)
target_include_directories(rayleaf_rivals PRIVATE ${CMAKE_SOURCE_DIR})
target_link_libraries(rayleaf_rivals PRIVATE rayleaf_core rayleaf_flags embree)
target_compile_options(rayleaf_rivals PRIVATE ${RAYLEAF_CHECKS_BY_CALLS})
set_target_properties(rayleaf_rivals PROPERTIES UNITY_BUILD OFF LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/rivals)

# The folder Blender sees through BLENDER_USER_SCRIPTS: the add-on's sources by link, the module beside them.
set(RAYLEAF_PACKAGE ${CMAKE_BINARY_DIR}/scripts/addons/rayleaf)
set_target_properties(_core PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${RAYLEAF_PACKAGE})
add_custom_target(rayleaf_package ALL
  COMMAND ${Python_EXECUTABLE} ${CMAKE_SOURCE_DIR}/python_addon/link_package.py ${CMAKE_SOURCE_DIR} ${RAYLEAF_PACKAGE}
  COMMENT "Linking the add-on's sources into ${RAYLEAF_PACKAGE}")
