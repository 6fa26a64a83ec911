# Flags of our own build; consumers never see them. Paths in messages and asserts are relative to the source tree, so
# that the same sources give the same binary wherever they lie.
add_library(groundscale_build_flags INTERFACE)
target_compile_options(groundscale_build_flags INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  $<$<BOOL:${GROUNDSCALE_WARNINGS_AS_ERRORS}>:-Werror>
  -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)
