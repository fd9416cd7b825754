# Packages: `cpack --preset command` makes a .deb and a .tar.gz of the files that `cmake --install`
# installs, in build/release/packages. See docs/architecture.md, "Packages".

# Documents, in the same folders as in the source, so that their links work.
install(FILES README.md CHANGELOG.md LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(DIRECTORY docs DESTINATION "${CMAKE_INSTALL_DOCDIR}"
        FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg" PATTERN "*.xml" PATTERN "*.xsd")
# The schema of scenes, where editors are told to look for it (docs/scene-format.md, "Schema").
install(FILES docs/pliant-scene.xsd DESTINATION "${CMAKE_INSTALL_DATADIR}/pliant")
# All of the examples: scenes name meshes of several formats, and documents name scripts.
install(DIRECTORY examples DESTINATION "${CMAKE_INSTALL_DOCDIR}" PATTERN "__pycache__" EXCLUDE)

include(PliantCopyright)
# The licence of the binary: its terms depend on the libraries that it is linked with.
set(pliant_licence_of_binary "License: Apache-2.0")
if(PLIANT_WITH_CHOLMOD)
  file(READ cmake/copyright_with_cholmod.txt pliant_licence_of_binary)
  string(STRIP "${pliant_licence_of_binary}" pliant_licence_of_binary)
endif()
pliant_copyright("${PROJECT_BINARY_DIR}/copyright" "${pliant_licence_of_binary}" "bin/pliant lib/libpliant_*.a")

# Debian requires a compressed changelog. -n omits name and time, so that the file depends on the text
# alone.
set(changelog "${PROJECT_BINARY_DIR}/changelog.gz")
add_custom_command(OUTPUT "${changelog}"
  COMMAND gzip -9nc "${PROJECT_SOURCE_DIR}/CHANGELOG.md" > "${changelog}"
  DEPENDS CHANGELOG.md COMMENT "Compressing the changelog" VERBATIM)
add_custom_target(pliant_changelog ALL DEPENDS "${changelog}")
install(FILES "${PROJECT_BINARY_DIR}/copyright" "${changelog}"
        DESTINATION "${CMAKE_INSTALL_DOCDIR}")

set(PLIANT_MAINTAINER "pliant maintainers <maintainers@pliant.invalid>" CACHE STRING
    "Maintainer of the packages: name and e-mail address")

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_PACKAGE_FILE_NAME
    "pliant-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}")
set(CPACK_PACKAGE_VENDOR "pliant")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "elastic animation of polygon surfaces")
set(CPACK_PACKAGE_DESCRIPTION
"pliant makes polygon surfaces elastic. A scene in XML names the surfaces, the
forces on them and the keyframes of every parameter. The command bakes the
animation to OBJ, PLY, glTF, USD, PC2, MDD and NumPy files, or writes a page
that plays it in a browser.
.
The package has the command, its completion for Bash, zsh and fish, the C++
library with its headers and its CMake package, the page of the viewer, the
documents and the examples.")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_STRIP_FILES ON)
# The permissions of installed folders must not depend on the umask of the packaging user.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)  # pliant_0.1.0_amd64.deb
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${PLIANT_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# For pictures and movies of `pliant view` and completion in Bash; then the build dependencies of
# programs that link the library. Suggested only, because the command needs none of them.
set(suggested chromium ffmpeg bash-completion
    cmake g++ libeigen3-dev libexpected-dev libfmt-dev libpng-dev libsleef-dev
    libxxhash-dev)
if(PLIANT_WITH_CHOLMOD)
  list(APPEND suggested libsuitesparse-dev)
endif()
if(PLIANT_WITH_OPENSUBDIV)
  list(APPEND suggested libosd-dev)
endif()
list(JOIN suggested ", " CPACK_DEBIAN_PACKAGE_SUGGESTS)

# Runs before each package is packed, on its files; sets CPACK_DEBIAN_PACKAGE_DEPENDS.
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/cmake/FinishPackage.cmake")
get_target_property(folder pliant_mesh_reader BINARY_DIR)
set(CPACK_PLIANT_MESH_READER "${folder}/pliant_mesh_reader")

include(CPack)
