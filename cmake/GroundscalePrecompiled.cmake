# Two precompiled headers, one for the modules and one for the tests: what nearly every file parses. Half of the time
# of a small file goes there (docs/decisions.md). Off with CMAKE_DISABLE_PRECOMPILE_HEADERS, as in the preset `tidy`,
# which is where a file that includes too little is found.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled.cpp CONTENT "")

add_library(groundscale_pch OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
target_compile_features(groundscale_pch PRIVATE cxx_std_20)
target_link_libraries(groundscale_pch PRIVATE groundscale_build_flags Eigen3::Eigen)
target_precompile_headers(groundscale_pch PRIVATE <optional> <string> <vector> <Eigen/Core>)
set_target_properties(groundscale_pch PROPERTIES POSITION_INDEPENDENT_CODE ON)

if(GROUNDSCALE_BUILD_TESTS)
  add_library(groundscale_test_pch OBJECT ${PROJECT_BINARY_DIR}/precompiled.cpp)
  target_compile_features(groundscale_test_pch PRIVATE cxx_std_20)
  target_link_libraries(groundscale_test_pch PRIVATE groundscale_build_flags Eigen3::Eigen GTest::gmock)
  target_precompile_headers(groundscale_test_pch PRIVATE <optional> <string> <vector> <Eigen/Core> <gmock/gmock.h>
                                                         <gtest/gtest.h>)
endif()
