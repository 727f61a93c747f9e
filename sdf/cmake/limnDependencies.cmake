# Every library limn stands on, found in one place: by the build, and by find_package(limn) in other projects.
# Debian 12 needs detours; each is explained where it is taken.
include(CMakeFindDependencyMacro)

find_dependency(Threads)
find_dependency(TBB)
find_dependency(glm)
find_dependency(fmt)

# OpenVDB ships only a find module. Its folder holds find modules for other libraries too, which would shadow CMake's, so it is
# on the path for this one call.
if(NOT TARGET OpenVDB::openvdb)
  find_path(LIMN_OPENVDB_MODULES FindOpenVDB.cmake
    PATH_SUFFIXES lib/cmake/OpenVDB lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB lib64/cmake/OpenVDB REQUIRED)
  mark_as_advanced(LIMN_OPENVDB_MODULES)
  list(PREPEND CMAKE_MODULE_PATH ${LIMN_OPENVDB_MODULES})
  find_dependency(OpenVDB)
  list(REMOVE_ITEM CMAKE_MODULE_PATH ${LIMN_OPENVDB_MODULES})
endif()

# OpenSubdiv's config file names a static library that Debian does not ship.
if(NOT TARGET limn_opensubdiv)
  find_path(LIMN_OPENSUBDIV_INCLUDE opensubdiv/version.h REQUIRED)
  find_library(LIMN_OPENSUBDIV_LIBRARY osdCPU REQUIRED)
  mark_as_advanced(LIMN_OPENSUBDIV_INCLUDE LIMN_OPENSUBDIV_LIBRARY)
  add_library(limn_opensubdiv UNKNOWN IMPORTED)
  set_target_properties(limn_opensubdiv PROPERTIES
    IMPORTED_LOCATION ${LIMN_OPENSUBDIV_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${LIMN_OPENSUBDIV_INCLUDE})
endif()

# OpenCV's config file comes with a package that needs all of its modules; two of them are used.
if(NOT TARGET limn_opencv)
  find_path(LIMN_OPENCV_INCLUDE opencv2/imgproc.hpp PATH_SUFFIXES opencv4 REQUIRED)
  find_library(LIMN_OPENCV_CORE opencv_core REQUIRED)
  find_library(LIMN_OPENCV_IMGPROC opencv_imgproc REQUIRED)
  mark_as_advanced(LIMN_OPENCV_INCLUDE LIMN_OPENCV_CORE LIMN_OPENCV_IMGPROC)
  add_library(limn_opencv INTERFACE IMPORTED)
  set_target_properties(limn_opencv PROPERTIES
    INTERFACE_LINK_LIBRARIES "${LIMN_OPENCV_IMGPROC};${LIMN_OPENCV_CORE}"
    INTERFACE_INCLUDE_DIRECTORIES ${LIMN_OPENCV_INCLUDE})
endif()

# OpenImageIO's config file insists on programs that come with another package.
find_dependency(Imath)
if(NOT TARGET limn_openimageio)
  find_path(LIMN_OPENIMAGEIO_INCLUDE OpenImageIO/imageio.h REQUIRED)
  find_library(LIMN_OPENIMAGEIO_LIBRARY OpenImageIO REQUIRED)
  find_library(LIMN_OPENIMAGEIO_UTIL_LIBRARY OpenImageIO_Util REQUIRED)
  mark_as_advanced(LIMN_OPENIMAGEIO_INCLUDE LIMN_OPENIMAGEIO_LIBRARY LIMN_OPENIMAGEIO_UTIL_LIBRARY)
  # Its library of helpers alone needs no other libraries.
  add_library(limn_openimageio_util INTERFACE IMPORTED)
  set_target_properties(limn_openimageio_util PROPERTIES
    INTERFACE_LINK_LIBRARIES "${LIMN_OPENIMAGEIO_UTIL_LIBRARY};Imath::Imath;fmt::fmt"
    INTERFACE_INCLUDE_DIRECTORIES ${LIMN_OPENIMAGEIO_INCLUDE})
  add_library(limn_openimageio INTERFACE IMPORTED)
  set_target_properties(limn_openimageio PROPERTIES INTERFACE_LINK_LIBRARIES "${LIMN_OPENIMAGEIO_LIBRARY};limn_openimageio_util")
endif()

find_dependency(PNG)  # brings zlib
find_dependency(OpenEXR)

# ISA-L has no config file.
if(NOT TARGET limn_isal)
  find_path(LIMN_ISAL_INCLUDE isa-l/igzip_lib.h REQUIRED)
  find_library(LIMN_ISAL_LIBRARY isal REQUIRED)
  mark_as_advanced(LIMN_ISAL_INCLUDE LIMN_ISAL_LIBRARY)
  add_library(limn_isal UNKNOWN IMPORTED)
  set_target_properties(limn_isal PROPERTIES IMPORTED_LOCATION ${LIMN_ISAL_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LIMN_ISAL_INCLUDE})
endif()

# limn_headers(NAME LIBRARY): the headers of a library that is not linked.
function(limn_headers name library)
  if(TARGET ${name})
    return()
  endif()
  add_library(${name} INTERFACE IMPORTED GLOBAL)
  foreach(property INTERFACE_COMPILE_DEFINITIONS INTERFACE_INCLUDE_DIRECTORIES)
    get_target_property(value ${library} ${property})
    if(value)
      set_property(TARGET ${name} PROPERTY ${property} ${value})
    endif()
  endforeach()
endfunction()
# Embree comes late (subdiv/embree_module.h); what Highway's headers ask of its library is in sdf/simd_targets.cpp.
find_dependency(embree 3)
find_dependency(hwy)
limn_headers(limn_embree_headers embree)
limn_headers(limn_highway hwy::hwy)
