# Writes OUT, a C++ source with the bytes of the file PAGE in the span NAME; empty PAGE: no bytes.
# usage: cmake -DPAGE=FILE -DNAME=NAME -DOUT=FILE -P EmbedPage.cmake
set(bytes)
if(PAGE)
  file(READ "${PAGE}" digits HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${digits}")
endif()
set(array "constexpr unsigned char bytes_of_${NAME}[] = {${bytes}};")
set(span "bytes_of_${NAME}")
if(NOT bytes)
  set(array)
  set(span)
endif()
file(WRITE "${OUT}" "#include <span>

namespace pliant::viewer {

${array}
extern const std::span<const unsigned char> ${NAME}{${span}};

}  // namespace pliant::viewer
")
