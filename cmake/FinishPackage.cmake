# cpack runs this script for each package after it has installed the files in a scratch folder and
# before it packs them. The script refuses a package without the viewer's page and adapts a .deb to
# Debian.
set(root "${CPACK_TEMPORARY_INSTALL_DIRECTORY}")
if(CPACK_GENERATOR STREQUAL "DEB")
  string(APPEND root "${CPACK_PACKAGING_INSTALL_PREFIX}")
endif()

if(NOT EXISTS "${root}/share/pliant/viewer.html")
  message(FATAL_ERROR "pliant: no package without the viewer's page. This build does not have it, "
                      "because npm's packages for viewer/page were not installed: run "
                      "script/bootstrap, then build again")
endif()
if(NOT CPACK_GENERATOR STREQUAL "DEB")
  return()
endif()

# Debian's zsh reads the completions of packages from vendor-completions. It does not search
# /usr/share/zsh/site-functions.
file(MAKE_DIRECTORY "${root}/share/zsh/vendor-completions")
file(RENAME "${root}/share/zsh/site-functions/_pliant" "${root}/share/zsh/vendor-completions/_pliant")
file(REMOVE_RECURSE "${root}/share/zsh/site-functions")

# The packages of the shared libraries. CPACK_DEBIAN_PACKAGE_SHLIBDEPS examines installed files only,
# and the program that reads FBX and Collada is embedded in the command.
find_program(PLIANT_SHLIBDEPS dpkg-shlibdeps)
if(NOT PLIANT_SHLIBDEPS)
  message(FATAL_ERROR "pliant: no .deb without dpkg-shlibdeps, which is in Debian's package dpkg-dev: "
                      "run script/bootstrap --package")
endif()
set(scratch "${CPACK_TEMPORARY_DIRECTORY}.shlibdeps")
file(WRITE "${scratch}/debian/control" "")  # dpkg-shlibdeps requires one
execute_process(
  COMMAND "${PLIANT_SHLIBDEPS}" -O "-e${root}/bin/pliant" "-e${CPACK_PLIANT_MESH_READER}"
  WORKING_DIRECTORY "${scratch}"
  OUTPUT_VARIABLE output ERROR_VARIABLE trouble RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR NOT output MATCHES "shlibs:Depends=([^\n]+)")
  message(FATAL_ERROR "pliant: dpkg-shlibdeps failed:\n${trouble}")
endif()
set(CPACK_DEBIAN_PACKAGE_DEPENDS "${CMAKE_MATCH_1}")
