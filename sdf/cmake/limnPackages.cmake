# Debian packages, made by `cpack` in a folder that was configured with -DLIMN_PACKAGE=ON -DCMAKE_INSTALL_PREFIX=/usr: `./run package`.
# DEBFULLNAME and DEBEMAIL name the maintainer, as for Debian's own tools; SOURCE_DATE_EPOCH the time of the entry in their changelog.

set(maintainer "limn developers <limn@packages.debian.org>")
if(DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL})
  set(maintainer "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()
set(components program dev doc)
if(LIMN_PYTHON_MODULE)
  list(APPEND components python)
endif()
set(program_package limn)
set(dev_package liblimn-dev)
set(doc_package limn-doc)
set(python_package python3-limn)

# What each package has in /usr/share/doc, as Debian's policy asks.
set(package_docs ${PROJECT_BINARY_DIR}/package-docs)
file(MAKE_DIRECTORY ${package_docs})
execute_process(COMMAND date -R -u -d @$ENV{SOURCE_DATE_EPOCH} OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE no_date)
if(no_date)
  execute_process(COMMAND date -R -u OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
file(WRITE ${package_docs}/changelog.Debian
  "limn (${PROJECT_VERSION}-1) bookworm; urgency=medium\n\n  * Packages of limn ${PROJECT_VERSION}; changelog.gz says what is new in it.\n\n -- ${maintainer}  ${date}\n")
configure_file(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${package_docs}/changelog COPYONLY)
foreach(name changelog changelog.Debian)
  execute_process(COMMAND gzip -9 -n -f ${package_docs}/${name} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
configure_file(${CMAKE_CURRENT_LIST_DIR}/copyright.in ${package_docs}/copyright @ONLY)
foreach(component IN LISTS components)
  install(FILES ${package_docs}/copyright ${package_docs}/changelog.gz ${package_docs}/changelog.Debian.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${${component}_package} COMPONENT ${component})
endforeach()
# The site and the reference of the headers (./run docs), where they were made before.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/build/site/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/limn-doc/html COMPONENT doc OPTIONAL)

set(CPACK_GENERATOR DEB)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_NAME limn)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${maintainer}")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "draws the border of implicit surfaces and measures it
Toon outlines, rims and contours mark where a surface turns away from the
eye. limn renders the same surface as a formula, a grid of distances, a
subdivision cage or triangles, draws its outline by any of a dozen methods,
and measures each result against the true border. It writes lines as SVG,
PDF and DXF, and judges drawings.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME limn)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS fonts-dejavu-core)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS limn-doc)

set(CPACK_COMPONENT_DEV_DESCRIPTION "libraries and headers of limn
Static libraries for scenes, level sets, subdivision surfaces, outlines, true
borders and their comparison in C++20, with CMake's configuration files:
find_package(limn).")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME liblimn-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
# What find_package(limn) looks for, and the helper programs that the libraries run.
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "limn (= ${PROJECT_VERSION}-1), libopenvdb-dev, libboost-dev, libboost-iostreams-dev, libblosc-dev, zlib1g-dev, libosd-dev, libopenimageio-dev, libopencv-core-dev, libopencv-imgproc-dev, libhwy-dev, libembree-dev, libtbb-dev, libglm-dev, libfmt-dev, libpng-dev, libopenexr-dev, libisal-dev, nlohmann-json3-dev, libcairo2-dev, libfreetype-dev, pkg-config")

set(CPACK_COMPONENT_DOC_DESCRIPTION "documentation of limn
How to start, a cookbook, the methods and how they fail, what was measured,
and the reference of the C++ headers, as web pages that work from disk.")
set(CPACK_DEBIAN_DOC_PACKAGE_NAME limn-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)

set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Python module of limn
Shapes, level sets and meshes from and to numpy arrays, pictures, true
contours, measurements and studies.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-limn)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/python3-limn/postinst ${CMAKE_CURRENT_LIST_DIR}/python3-limn/prerm)
# The module is built for one version of Python and the next minor one does not load it.
if(LIMN_PYTHON_MODULE)
  execute_process(COMMAND ${LIMN_PYTHON} -c "import sys; print('python3 (>= %d.%d), python3 (<< %d.%d)' % (*sys.version_info[:2], sys.version_info[0], sys.version_info[1] + 1))"
    OUTPUT_VARIABLE python_version OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "limn (= ${PROJECT_VERSION}-1), ${python_version}, python3-numpy")
endif()
include(CPack)
