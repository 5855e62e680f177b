include(GNUInstallDirs)

# knotreel_module(NAME SOURCES a.cpp ... LINK public libs PRIVATE_LINK private libs)
# makes the static library knotreel_NAME with the alias knotreel::NAME.
function(knotreel_module name)
  cmake_parse_arguments(M "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(knotreel_${name} STATIC ${M_SOURCES})
  add_library(knotreel::${name} ALIAS knotreel_${name})
  target_include_directories(knotreel_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_compile_features(knotreel_${name} PUBLIC cxx_std_20)
  target_link_libraries(knotreel_${name} PUBLIC ${M_LINK} PRIVATE ${M_PRIVATE_LINK}
    $<BUILD_INTERFACE:Boost::headers> $<BUILD_INTERFACE:knotreel_flags>)
  set_target_properties(knotreel_${name} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY KNOTREEL_MODULES knotreel_${name})
endfunction()
