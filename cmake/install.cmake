# Library, headers, program, and what find_package(knotreel) and pkg-config need to know.
include(CMakePackageConfigHelpers)

get_property(modules GLOBAL PROPERTY KNOTREEL_MODULES)
install(TARGETS ${modules} EXPORT knotreelTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS knotreel RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY include/knotreel DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md" PATTERN "*.jpg")

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/knotreel)
install(EXPORT knotreelTargets NAMESPACE knotreel:: DESTINATION ${package_dir})
configure_package_config_file(cmake/knotreelConfig.cmake.in ${PROJECT_BINARY_DIR}/knotreelConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/knotreelConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/knotreelConfig.cmake ${PROJECT_BINARY_DIR}/knotreelConfigVersion.cmake
  DESTINATION ${package_dir})

# A linker reads static libraries once, from left to right: users before what they use.
set(KNOTREEL_PC_LIBS)
foreach(module IN LISTS modules)
  get_target_property(name ${module} NAME)
  list(PREPEND KNOTREEL_PC_LIBS -l${name})
endforeach()
list(JOIN KNOTREEL_PC_LIBS " " KNOTREEL_PC_LIBS)
# From <libdir>/pkgconfig up to the prefix, so that an install tree may be moved.
file(RELATIVE_PATH KNOTREEL_PC_UP /prefix/${CMAKE_INSTALL_LIBDIR} /prefix)
configure_file(cmake/knotreel.pc.in ${PROJECT_BINARY_DIR}/knotreel.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/knotreel.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
