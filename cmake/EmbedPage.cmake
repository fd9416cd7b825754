# Writes OUT, a C++ source with the bytes of the file PAGE; empty PAGE: no bytes.
# usage: cmake -DPAGE=FILE -DOUT=FILE -P EmbedPage.cmake
set(bytes)
if(PAGE)
  file(READ "${PAGE}" digits HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${digits}")
endif()
set(array "constexpr unsigned char page[] = {${bytes}};")
set(span "page")
if(NOT bytes)
  set(array)
  set(span)
endif()
file(WRITE "${OUT}" "#include <span>

namespace pliant::viewer {

${array}
extern const std::span<const unsigned char> embedded_page{${span}};

}  // namespace pliant::viewer
")
