# The library for hosts: one shared and one static, from the objects that the programs are made of, and the package.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(parts lambent_core lambent_view lambent_trace lambent_plan lambent_vpl lambent_gl lambent_gi)
set(objects ${parts})
list(TRANSFORM objects REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>")
set(needs glm::glm TBB::tbb Threads::Threads embree nanoflann::nanoflann PkgConfig::EPOXY ${CMAKE_DL_LIBS})

add_library(lambent_shared SHARED ${objects})
add_library(lambent_static STATIC ${objects})
foreach(library lambent_shared lambent_static)
  set_target_properties(${library} PROPERTIES OUTPUT_NAME lambent LINKER_LANGUAGE CXX UNITY_BUILD OFF)
  target_include_directories(${library} INTERFACE $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/gi>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endforeach()
set_target_properties(lambent_shared PROPERTIES EXPORT_NAME lambent VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR} LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib
                      LINK_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/lambent.map)
set_target_properties(lambent_static PROPERTIES ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
target_link_libraries(lambent_shared PRIVATE ${needs})
target_link_options(lambent_shared PRIVATE -Wl,--no-undefined -Wl,--version-script=${CMAKE_SOURCE_DIR}/cmake/lambent.map)
if(LAMBENT_SANITIZE)
  target_link_options(lambent_shared PRIVATE -fsanitize=address,undefined)
endif()
target_link_libraries(lambent_static INTERFACE TBB::tbb Threads::Threads embree PkgConfig::EPOXY ${CMAKE_DL_LIBS} stdc++ m)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Lambent)
install(TARGETS lambent_shared EXPORT LambentShared DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS lambent_static EXPORT LambentStatic DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT LambentShared NAMESPACE Lambent:: DESTINATION ${package})
install(EXPORT LambentStatic NAMESPACE Lambent:: DESTINATION ${package})
install(FILES gi/lambent.h gi/lambent.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
configure_package_config_file(cmake/LambentConfig.cmake.in LambentConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(LambentConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/LambentConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/LambentConfigVersion.cmake
        DESTINATION ${package})

file(RELATIVE_PATH prefix_from_pc /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
configure_file(cmake/lambent.pc.in lambent.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/lambent.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
