# Install and export: find_package(pliant) in another project defines pliant::pliant.
include(CMakePackageConfigHelpers)

set(pliant_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/pliant")
install(EXPORT pliant NAMESPACE pliant:: DESTINATION "${pliant_package_dir}"
        FILE pliant-targets.cmake)
configure_package_config_file(cmake/pliant-config.cmake.in
  "${PROJECT_BINARY_DIR}/pliant-config.cmake" INSTALL_DESTINATION "${pliant_package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/pliant-config-version.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES script/blender_curves.py DESTINATION "${CMAKE_INSTALL_DATADIR}/pliant")
install(FILES
  "${PROJECT_BINARY_DIR}/pliant-config.cmake"
  "${PROJECT_BINARY_DIR}/pliant-config-version.cmake"
  cmake/PliantReplayTest.cmake cmake/FindSleef.cmake cmake/FindxxHash.cmake cmake/FindCHOLMOD.cmake
  cmake/FindOpenSubdiv.cmake
  DESTINATION "${pliant_package_dir}")
