# How this project declares its libraries, tools and tests.

# tdpt_library(room SOURCES ... LINK ...): one room of libcommon.
function(tdpt_library name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name} STATIC ${A_SOURCES})
  target_include_directories(${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${A_LINK} PRIVATE ${A_PRIVATE_LINK})
endfunction()

# tdpt_tool(name SOURCES ... LINK ...): <name>_lib holds everything but main.cpp, so that tests reach it.
function(tdpt_tool name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name}_lib STATIC ${A_SOURCES})
  target_include_directories(${name}_lib PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name}_lib PUBLIC ${A_LINK} PRIVATE ${A_PRIVATE_LINK})
  add_executable(${name} main.cpp)
  target_link_libraries(${name} PRIVATE ${name}_lib)
  install(TARGETS ${name})
endfunction()

# tdpt_test(name SOURCES ... LINK ...): a GoogleTest program; each test is a ctest test.
function(tdpt_test name)
  cmake_parse_arguments(A "" "TIMEOUT" "SOURCES;LINK" ${ARGN})
  if(NOT BUILD_TESTING)
    return()
  endif()
  if(NOT A_TIMEOUT)
    set(A_TIMEOUT 120)
  endif()
  add_executable(${name} ${A_SOURCES})
  target_link_libraries(${name} PRIVATE ${A_LINK} GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    TDPT_TESTDATA="${CMAKE_SOURCE_DIR}/testdata" TDPT_BIN="${CMAKE_BINARY_DIR}/bin"
    TDPT_SHARED="${CMAKE_SOURCE_DIR}/../shared")
  gtest_discover_tests(${name} TEST_PREFIX ${name}. DISCOVERY_MODE PRE_TEST
                       PROPERTIES TIMEOUT ${A_TIMEOUT} ENVIRONMENT
                       LSAN_OPTIONS=suppressions=${CMAKE_SOURCE_DIR}/libcommon/testing/lsan.supp)
endfunction()
include(GoogleTest)

# tdpt_bench(name SOURCES ... LINK ...): a program that prints ratios; built, never run as a test.
function(tdpt_bench name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK" ${ARGN})
  if(BUILD_TESTING)
    add_executable(${name} ${A_SOURCES})
    target_link_libraries(${name} PRIVATE ${A_LINK})
  endif()
endfunction()
