# The library for glTF scenes and their entities: a host of lambent.h itself. Installed where asked for:
# cmake --install build --component world
add_library(lambent_world SHARED gi/world/sync.cpp gi/world/world.cpp $<TARGET_OBJECTS:lambent_core> $<TARGET_OBJECTS:lambent_view>
            $<TARGET_OBJECTS:lambent_image> $<TARGET_OBJECTS:lambent_scene>)
set_target_properties(lambent_world PROPERTIES EXPORT_NAME world VERSION ${PROJECT_VERSION}
                      SOVERSION ${PROJECT_VERSION_MAJOR} LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib UNITY_BUILD OFF
                      INSTALL_RPATH $ORIGIN LINK_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/lambent.map)
target_link_libraries(lambent_world PRIVATE lambent_options glm::glm TBB::tbb Threads::Threads lambent_gltf
                      PkgConfig::STB OpenEXR::OpenEXR PUBLIC lambent_shared)
target_link_options(lambent_world PRIVATE -Wl,--no-undefined -Wl,--version-script=${CMAKE_SOURCE_DIR}/cmake/lambent.map)
if(LAMBENT_SANITIZE)
  target_link_options(lambent_world PRIVATE -fsanitize=address,undefined)
endif()
install(TARGETS lambent_world EXPORT LambentWorld DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT world EXCLUDE_FROM_ALL)
install(EXPORT LambentWorld NAMESPACE Lambent:: DESTINATION ${package} COMPONENT world EXCLUDE_FROM_ALL)
install(FILES gi/lambent_world.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT world EXCLUDE_FROM_ALL)
