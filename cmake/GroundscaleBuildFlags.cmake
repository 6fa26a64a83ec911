# Flags of our own build; consumers never see them. Paths in messages and asserts are relative to the source tree, so
# that the same sources give the same binary wherever they lie.
add_library(groundscale_build_flags INTERFACE)
target_compile_options(groundscale_build_flags INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual -Wsuggest-override
  $<$<BOOL:${GROUNDSCALE_WARNINGS_AS_ERRORS}>:-Werror>
  # GCC 12 sees overlaps and overflows in std::string that aren't there (its bugs 105329 and 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict;-Wno-stringop-overflow>
  # With sanitizers, GCC takes the insides of std::regex and of others for uninitialised: it documents such false alarms.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Debug>>:-Wno-maybe-uninitialized>
  -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)

# 180 programs are linked a build, in a fifth of the time with gold.
include(CheckLinkerFlag)
check_linker_flag(CXX -fuse-ld=gold GROUNDSCALE_HAS_GOLD)
if(GROUNDSCALE_HAS_GOLD)
  target_link_options(groundscale_build_flags INTERFACE -fuse-ld=gold)
endif()
