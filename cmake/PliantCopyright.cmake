# pliant_copyright(FILE LICENCE BINARIES [HOLDER…]): the copyright file of binaries, in Debian's format, with
# what is compiled into them. LICENCE is the line of the whole; HOLDERs have more code in them than ours have.
function(pliant_copyright file pliant_licence_of_binary pliant_binaries)
  set(pliant_more_holders)
  foreach(holder IN LISTS ARGN)
    string(APPEND pliant_more_holders "\n           ${holder}")
  endforeach()
  foreach(part holders licence text)
    set(pliant_opensubdiv_${part})
  endforeach()
  if(PLIANT_WITH_OPENSUBDIV)
    set(pliant_opensubdiv_holders "
           2013-2022, Pixar Animation Studios (OpenSubdiv)
           2014-2020, DreamWorks Animation LLC (OpenSubdiv)")
    set(pliant_opensubdiv_licence " and Apache-2.0-OpenSubdiv")
    file(READ "${PROJECT_SOURCE_DIR}/cmake/copyright_with_opensubdiv.txt" pliant_opensubdiv_text)
  endif()
  configure_file("${PROJECT_SOURCE_DIR}/cmake/copyright.in" "${file}" @ONLY)
endfunction()
