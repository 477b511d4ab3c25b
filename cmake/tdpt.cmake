# Declares this project's libraries, tools and tests.
include(libraries)

# tdpt_library(room SOURCES ... LINK ...): one room of libcommon.
function(tdpt_library name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  add_library(${name} STATIC ${A_SOURCES})
  set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  target_include_directories(${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${A_LINK} PRIVATE ${A_PRIVATE_LINK})
endfunction()

# tdpt_tool(name SOURCES ... LINK ...): <name>_lib holds everything but main.cpp, so that tests can link it.
function(tdpt_tool name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  if(A_SOURCES)
    add_library(${name}_lib STATIC ${A_SOURCES})
    set_target_properties(${name}_lib PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    target_include_directories(${name}_lib PUBLIC ${CMAKE_SOURCE_DIR})
    target_link_libraries(${name}_lib PUBLIC ${A_LINK} PRIVATE ${A_PRIVATE_LINK})
  else()  # main.cpp is all
    add_library(${name}_lib INTERFACE)
    target_link_libraries(${name}_lib INTERFACE ${A_LINK} ${A_PRIVATE_LINK})
  endif()
  add_executable(${name} main.cpp ${CMAKE_BINARY_DIR}/generated/${name}/built_with.cpp)
  target_link_libraries(${name} PRIVATE ${name}_lib)
  cmake_language(EVAL CODE "cmake_language(DEFER CALL tdpt_tell_origin ${name})")
  install(TARGETS ${name})
  tdpt_completions(${name})
endfunction()

# tdpt_completions(tool): the completion script for bash, written by the tool whenever it is built, and installed where
# bash looks.
function(tdpt_completions tool)
  set(bash ${CMAKE_BINARY_DIR}/completions/bash/${tool})
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/completions/bash)
  add_custom_command(TARGET ${tool} POST_BUILD COMMAND ${tool} --completion bash > ${bash} BYPRODUCTS ${bash} VERBATIM)
  install(FILES ${bash} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
endfunction()

# tdpt_sources(out ROOM ...): the sources in these folders that are neither tests nor benchmarks.
function(tdpt_sources out)
  list(TRANSFORM ARGN APPEND /*.cpp OUTPUT_VARIABLE patterns)
  file(GLOB sources RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS ${patterns})
  list(FILTER sources EXCLUDE REGEX "_(test|bench|fuzz)[.]cpp$")
  set(${out} ${sources} PARENT_SCOPE)
endfunction()

# tdpt_test(name FOLDER f LINK ...): all *_test.cpp of a folder (or SOURCES ...) as one GoogleTest program; each test is
# a ctest test. Suites named long_* are for `make test-long`. Compiled six files at a time, which takes half as long, so
# each has a namespace of its own.
function(tdpt_test name)
  cmake_parse_arguments(A "" "TIMEOUT;FOLDER" "SOURCES;LINK" ${ARGN})
  if(A_FOLDER)
    file(GLOB tests RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS ${A_FOLDER}/*_test.cpp)
    list(APPEND A_SOURCES ${tests})
  endif()
  if(NOT BUILD_TESTING)
    return()
  endif()
  if(NOT A_TIMEOUT)
    set(A_TIMEOUT 120)
  endif()
  add_executable(${name} ${A_SOURCES})
  set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
  target_link_libraries(${name} PRIVATE ${A_LINK} GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    TDPT_TESTDATA="${CMAKE_SOURCE_DIR}/testdata" TDPT_BIN="${CMAKE_BINARY_DIR}/bin"
    TDPT_SHARED="${CMAKE_SOURCE_DIR}/../shared")
  set(environment ENVIRONMENT LSAN_OPTIONS=suppressions=${CMAKE_SOURCE_DIR}/libcommon/testing/lsan.supp)
  set(discover TEST_PREFIX ${name}. NO_PRETTY_VALUES DISCOVERY_MODE PRE_TEST)
  gtest_discover_tests(${name} ${discover} TEST_FILTER -long_* PROPERTIES TIMEOUT ${A_TIMEOUT} ${environment})
  gtest_discover_tests(${name} ${discover} TEST_FILTER long_* TEST_LIST ${name}_LONG_TESTS
                       PROPERTIES LABELS long TIMEOUT 1800 ${environment})
endfunction()
include(GoogleTest)

# tdpt_power(program name FILTER): a test of `make test-long`: runs these tests of the program with 200 fresh seeds;
# they must neither raise false alarms nor miss a fault (libcommon/testing/statistics/power.sh).
function(tdpt_power program name filter)
  if(BUILD_TESTING)
    add_test(NAME power.${name} COMMAND sh ${CMAKE_SOURCE_DIR}/libcommon/testing/statistics/power.sh
                                         ${CMAKE_BINARY_DIR}/bin 200 ${program} ${filter})
    set_tests_properties(power.${name} PROPERTIES LABELS long TIMEOUT 36000)
  endif()
endfunction()

# tdpt_bench(name SOURCES ... LINK ...): a program that prints measurements; built, never run as a test.
function(tdpt_bench name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK" ${ARGN})
  if(BUILD_TESTING)
    add_executable(${name} ${A_SOURCES})
    target_link_libraries(${name} PRIVATE ${A_LINK})
  endif()
endfunction()

# tdpt_fuzz(name SOURCES ... LINK ...): a libFuzzer target, LLVMFuzzerTestOneInput, whose bytes a reader must read or
# refuse. With TDPT_FUZZ it is the program <name>_fuzz, one of `fuzzers`; else <name>_replay, which the test fuzz.<name>
# runs on the stored inputs of testdata/fuzz/<name>.tar.gz. "planted" has none.
function(tdpt_fuzz name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK" ${ARGN})
  if(TDPT_FUZZ)
    add_executable(${name}_fuzz EXCLUDE_FROM_ALL ${A_SOURCES})
    target_link_libraries(${name}_fuzz PRIVATE ${A_LINK})
    target_link_options(${name}_fuzz PRIVATE -fsanitize=fuzzer)
    if(NOT TARGET fuzzers)
      add_custom_target(fuzzers)
    endif()
    add_dependencies(fuzzers ${name}_fuzz)
  elseif(BUILD_TESTING)
    add_executable(${name}_replay ${A_SOURCES})
    target_link_libraries(${name}_replay PRIVATE ${A_LINK} fuzz_replay)
    if(NOT name STREQUAL "planted")
      add_test(NAME fuzz.${name}
               COMMAND sh ${CMAKE_SOURCE_DIR}/libcommon/testing/files/fuzz_replay.sh $<TARGET_FILE:${name}_replay>
                       ${CMAKE_SOURCE_DIR}/testdata/fuzz/${name}.tar.gz ${CMAKE_BINARY_DIR}/fuzz/${name})
      set_tests_properties(fuzz.${name} PROPERTIES LABELS fuzz TIMEOUT 120 ENVIRONMENT
                           LSAN_OPTIONS=suppressions=${CMAKE_SOURCE_DIR}/libcommon/testing/lsan.supp)
    endif()
  endif()
endfunction()

# tdpt_shaders(target a/NAME.comp ...): kernels, compiled into the target; paths from the source root. C++ includes
# "shaders/NAME.h" for the span NAME_spv. Each kernel belongs to one target. A test checks that its arithmetic is exact
# (cmake/spirv-exact.sh); with INEXACT, that it is found to be inexact.
function(tdpt_shaders target)
  cmake_parse_arguments(A "INEXACT" "SUFFIX;DEFINE" "" ${ARGN})
  set(folder ${CMAKE_BINARY_DIR}/generated/shaders)
  foreach(file IN LISTS A_UNPARSED_ARGUMENTS)
    get_filename_component(name ${file} NAME_WE)
    string(APPEND name "${A_SUFFIX}")
    set(source ${CMAKE_SOURCE_DIR}/${file})
    set(out ${folder}/${name})
    set(compile ${CMAKE_COMMAND} -E env INEXACT=$<BOOL:${A_INEXACT}> sh ${CMAKE_SOURCE_DIR}/cmake/compile-shader.sh ${out}
        -I ${CMAKE_SOURCE_DIR})
    if(A_DEFINE)
      list(APPEND compile "-D${A_DEFINE}")
    endif()
    file(CONFIGURE OUTPUT ${out}.h CONTENT
"#pragma once
#include <cstdint>
#include <span>
namespace tdpt::shader {
inline constexpr uint32_t @name@_words[] =
#include \"shaders/@name@.inc\"
    ;
inline constexpr std::span<const uint32_t> @name@_spv{@name@_words};
}  // namespace tdpt::shader
" @ONLY)
    add_custom_command(OUTPUT ${out}.inc ${out}.spv
      COMMAND ${compile} ${source}
      DEPENDS ${source} ${CMAKE_SOURCE_DIR}/cmake/compile-shader.sh DEPFILE ${out}.d
      COMMENT "Compiling the kernel ${name}" VERBATIM)
    target_sources(${target} PRIVATE ${out}.inc)
    if(BUILD_TESTING)
      add_test(NAME shaders.${name}-is-exact COMMAND sh ${CMAKE_SOURCE_DIR}/cmake/spirv-exact.sh ${out}.spv)
      if(A_INEXACT)
        set_tests_properties(shaders.${name}-is-exact PROPERTIES PASS_REGULAR_EXPRESSION "may be fused.*not exact")
      endif()
    endif()
  endforeach()
  target_include_directories(${target} PUBLIC ${CMAKE_BINARY_DIR}/generated)
endfunction()

# tdpt_software_vulkan(test ...): runs these tests on Mesa's lavapipe, whatever devices the machine has, with Vulkan's
# validation. A test is a name given to add_test or a program given to tdpt_test. Mesa's LLVM compiles without
# optimisations, which takes half as long; cli.tdpt-render-gpu enables them. Newer validation layers check what kernels
# write only if asked to.
file(GLOB TDPT_LAVAPIPE /usr/share/vulkan/icd.d/lvp_icd*.json /usr/local/share/vulkan/icd.d/lvp_icd*.json
     /etc/vulkan/icd.d/lvp_icd*.json)
function(tdpt_software_vulkan)
  list(APPEND TDPT_LAVAPIPE lavapipe-is-not-installed)
  list(GET TDPT_LAVAPIPE 0 driver)
  set(environment
      "VK_ICD_FILENAMES=set:${driver};VK_DRIVER_FILES=set:${driver};TDPT_VULKAN_VALIDATION=set:1;GALLIVM_PERF=set:nopt;VK_KHRONOS_VALIDATION_SYNCVAL_SHADER_ACCESSES_HEURISTIC=set:true")
  foreach(test IN LISTS ARGN)
    if(TARGET ${test})  # its tests are not known before ctest runs
      set(script ${CMAKE_CURRENT_BINARY_DIR}/${test}_software_vulkan.cmake)
      file(WRITE ${script}
           "set_tests_properties(\${${test}_TESTS} \${${test}_LONG_TESTS} PROPERTIES ENVIRONMENT_MODIFICATION \"${environment}\")\n")
      set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${script})
    else()
      set_tests_properties(${test} PROPERTIES ENVIRONMENT_MODIFICATION "${environment}")
    endif()
  endforeach()
endfunction()
