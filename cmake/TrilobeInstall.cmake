# Installs the libraries with their headers, the program, the licence, and a CMake package, so that
# find_package(trilobe) gives trilobe::trilobe and trilobe::evaluate.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/trilobe)

# The part that only evaluates models is its own component, to be installed and found without the rest.
install(TARGETS trilobe_evaluate EXPORT trilobe-evaluate COMPONENT evaluate
        FILE_SET HEADERS COMPONENT evaluate)
install(EXPORT trilobe-evaluate NAMESPACE trilobe:: DESTINATION ${package_dir} COMPONENT evaluate)
if(TRILOBE_BUILD_LIBRARY)
  install(TARGETS trilobe EXPORT trilobe-library FILE_SET HEADERS)
  install(EXPORT trilobe-library NAMESPACE trilobe:: DESTINATION ${package_dir})
endif()
if(TRILOBE_BUILD_APP)
  if(BUILD_SHARED_LIBS)
    # The program finds the library beside it, wherever the prefix is moved.
    file(RELATIVE_PATH library_dir ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
    set_target_properties(trilobe_app PROPERTIES INSTALL_RPATH "$ORIGIN/${library_dir}")
  endif()
  install(TARGETS trilobe_app)
  install(FILES ${PROJECT_SOURCE_DIR}/scripts/trilobe.bash
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME trilobe)
  # The program writes its manual itself.
  set(man_page ${PROJECT_BINARY_DIR}/trilobe.1)
  install(CODE "execute_process(COMMAND \"$<TARGET_FILE:trilobe_app>\" help --man
                                OUTPUT_FILE \"${man_page}\" COMMAND_ERROR_IS_FATAL ANY)")
  install(FILES ${man_page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()

configure_package_config_file(cmake/trilobe-config.cmake.in trilobe-config.cmake
                              INSTALL_DESTINATION ${package_dir})
# Below 1.0 a new minor version may change the interface.
write_basic_package_version_file(trilobe-config-version.cmake COMPATIBILITY SameMinorVersion)
# What is built is a package, too, which pip's builds take (TrilobeBuilt).
export(EXPORT trilobe-evaluate NAMESPACE trilobe:: FILE ${PROJECT_BINARY_DIR}/trilobe-evaluate.cmake)
if(TRILOBE_BUILD_LIBRARY)
  export(EXPORT trilobe-library NAMESPACE trilobe:: FILE ${PROJECT_BINARY_DIR}/trilobe-library.cmake)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT evaluate)
install(FILES ${PROJECT_BINARY_DIR}/trilobe-config.cmake
              ${PROJECT_BINARY_DIR}/trilobe-config-version.cmake
        DESTINATION ${package_dir} COMPONENT evaluate)
