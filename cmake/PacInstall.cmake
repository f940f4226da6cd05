# `cmake --install` puts headers under include/pac, libraries, the pac command, and files for find_package(pac).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(pac_libraries GLOBAL PROPERTY PAC_LIBRARIES)
install(TARGETS ${pac_libraries} EXPORT pac-targets)
install(TARGETS pac_cli)
foreach(dir base raster jpeg mpeg1 geomcodec sim)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${dir} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pac
          FILES_MATCHING PATTERN "*.h" PATTERN "cli" EXCLUDE)
endforeach()
install(EXPORT pac-targets NAMESPACE pac:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pac)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/pac-config.cmake.in ${PROJECT_BINARY_DIR}/pac-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pac)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pac-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pac-config.cmake ${PROJECT_BINARY_DIR}/pac-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/pac)
