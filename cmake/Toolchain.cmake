# Compiler cache, fast linker, warnings and sanitizers for every target of the project.
find_program(LIGHTWELL_CCACHE ccache)
if(LIGHTWELL_CCACHE)
  set(CMAKE_C_COMPILER_LAUNCHER ${LIGHTWELL_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${LIGHTWELL_CCACHE})
endif()
find_program(LIGHTWELL_LLD ld.lld)
if(LIGHTWELL_LLD)
  add_link_options(-fuse-ld=lld)
endif()

add_library(lightwell_options INTERFACE)  # linked privately by each of the project's targets
target_compile_options(lightwell_options INTERFACE -Wall -Wextra $<$<COMPILE_LANGUAGE:CXX>:-Wno-missing-field-initializers>)
target_include_directories(lightwell_options INTERFACE ${PROJECT_SOURCE_DIR})
# Contraction into fused multiply-adds differs between call sites; without it the same source gives the same bytes.
target_compile_options(lightwell_options INTERFACE -ffp-contract=off)

if(LIGHTWELL_SANITIZE)
  add_compile_options(-fsanitize=${LIGHTWELL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g)
  add_link_options(-fsanitize=${LIGHTWELL_SANITIZE})
endif()
if(LIGHTWELL_BUILD_FUZZERS)
  add_compile_options(-fsanitize=fuzzer-no-link)  # the fuzzers see which branches of every library an input takes
endif()
