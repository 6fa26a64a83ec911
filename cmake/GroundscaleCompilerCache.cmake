# ccache as compiler launcher, unless the caller names a launcher. Precompiled headers need the two sloppiness settings
# (ccache's manual, "Precompiled headers").
if(GROUNDSCALE_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(GROUNDSCALE_CCACHE_PROGRAM ccache)
  mark_as_advanced(GROUNDSCALE_CCACHE_PROGRAM)
  if(GROUNDSCALE_CCACHE_PROGRAM)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
                                    ${GROUNDSCALE_CCACHE_PROGRAM})
  endif()
endif()
