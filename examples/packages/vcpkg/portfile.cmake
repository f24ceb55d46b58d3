# An overlay port that has its sources beside it: vcpkg install flexbeam --overlay-ports=build/packages/vcpkg
set(VCPKG_BUILD_TYPE release) # there is nothing to build
file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/flexbeam.h" "${CMAKE_CURRENT_LIST_DIR}/flexbeam_impl.h"
     DESTINATION "${CURRENT_PACKAGES_DIR}/include")
file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/flexbeamConfig.cmake" "${CMAKE_CURRENT_LIST_DIR}/flexbeamConfigVersion.cmake"
     DESTINATION "${CURRENT_PACKAGES_DIR}/share/flexbeam")
vcpkg_install_copyright(FILE_LIST "${CMAKE_CURRENT_LIST_DIR}/LICENSE")
