# Writes OUT, a C++ source that defines NAMESPACE::NAME, a std::span of the bytes of FILE.
# usage: cmake -DFILE=FILE -DNAMESPACE=NAMESPACE -DNAME=NAME -DOUT=FILE -P EmbedFile.cmake
file(READ "${FILE}" digits HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${digits}")
file(WRITE "${OUT}" "#include <span>

namespace ${NAMESPACE} {

constexpr unsigned char bytes_of_${NAME}[] = {${bytes}};
extern const std::span<const unsigned char> ${NAME}{bytes_of_${NAME}};

}  // namespace ${NAMESPACE}
")
