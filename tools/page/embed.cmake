# Called by the build: turns files into a header of string views in the namespace <folder>_assets.
#   cmake -DOUT=assets.h -DFOLDER=page -DFILES="a.css;b.js" -P embed.cmake
set(text "#pragma once\n\n#include <string_view>\n\nnamespace roomcal::tools::${FOLDER}_assets {\n\n")
foreach(file ${FILES})
  get_filename_component(name ${file} NAME)
  string(REPLACE "." "_" name ${name})
  file(READ ${file} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${hex}")
  string(APPEND text "inline constexpr char ${name}_bytes[] = {${bytes}};\n"
         "inline constexpr std::string_view ${name}(${name}_bytes, sizeof ${name}_bytes);\n\n")
endforeach()
file(WRITE ${OUT} "${text}}  // namespace roomcal::tools::${FOLDER}_assets\n")
