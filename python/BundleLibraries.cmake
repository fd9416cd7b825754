# Installs what the module needs and a system need not have: shared libraries, also those of the program
# that reads FBX and Collada (which looks for them there too), and their licences.
# In: module, reader, and, as in each script of an installation, CMAKE_INSTALL_PREFIX.
set(folder "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/pliant/libs")
# Of the C and C++ runtimes and of zlib, as for all wheels of Linux (manylinux).
set(of_the_system "^(ld-linux.*|lib(c|m|dl|rt|pthread|stdc\\+\\+|gcc_s|z))\\.so.*")
file(GET_RUNTIME_DEPENDENCIES MODULES "${module}" EXECUTABLES "${reader}"
     RESOLVED_DEPENDENCIES_VAR libraries PRE_EXCLUDE_REGEXES "${of_the_system}")
file(MAKE_DIRECTORY "${folder}")
foreach(library IN LISTS libraries)
  cmake_path(GET library FILENAME name)
  file(REAL_PATH "${library}" real)
  message(STATUS "Installing: ${folder}/${name}")
  file(COPY_FILE "${real}" "${folder}/${name}")
  # Debian has a file of the licences of each package.
  execute_process(COMMAND dpkg -S "${real}" OUTPUT_VARIABLE owner ERROR_QUIET)
  string(REGEX REPLACE "[:,].*" "" owner "${owner}")
  if(EXISTS "/usr/share/doc/${owner}/copyright")
    file(COPY_FILE "/usr/share/doc/${owner}/copyright" "${folder}/${name}.licence.txt")
  endif()
endforeach()
