# Install and export: find_package(groundscale) gives groundscale::groundscale and a target a module.
include(CMakePackageConfigHelpers)

set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/groundscale)
get_property(modules GLOBAL PROPERTY GROUNDSCALE_MODULES)
install(TARGETS groundscale ${modules} EXPORT groundscaleTargets FILE_SET HEADERS)
install(EXPORT groundscaleTargets NAMESPACE groundscale:: DESTINATION ${config_folder})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/groundscaleConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/groundscaleConfig.cmake INSTALL_DESTINATION ${config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/groundscaleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/groundscaleConfig.cmake ${PROJECT_BINARY_DIR}/groundscaleConfigVersion.cmake
        DESTINATION ${config_folder})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
