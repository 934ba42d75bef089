# cmake -DGIT=git -DSOURCE=checkout -DOUT=header -P commit.cmake: a header with the commit of the sources, touched only if it
# has become another one.
cmake_minimum_required(VERSION 3.25)
set(commit "unknown")
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse --short=10 HEAD
                  OUTPUT_VARIABLE hash OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  execute_process(COMMAND ${GIT} -C ${SOURCE} status --porcelain -- runtime tools CMakeLists.txt
                  OUTPUT_VARIABLE changes ERROR_QUIET)
  if(NOT failed AND hash)
    set(commit "${hash}")
    if(changes)
      string(APPEND commit "+changes")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "inline constexpr char kCommit[] = \"@commit@\";\n" @ONLY)
