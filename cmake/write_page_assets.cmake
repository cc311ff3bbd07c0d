# SPDX-License-Identifier: Apache-2.0
# Script and style sheet of pages as a C file, with the hash by which a page allows its script:
#
#     cmake -DOUTPUT=page_assets.c -P cmake/write_page_assets.cmake
#
# What it defines is declared in src/report/page_internal.h. The whole script is also left beside it,
# as page_script.js.
set(folder ${CMAKE_CURRENT_LIST_DIR}/../src/report/page)

# The bytes of a file as the elements of an array that ends with a zero.
function(read_bytes file result)
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "((0x..,)(0x..,)(0x..,)(0x..,)(0x..,)(0x..,)(0x..,)(0x..,))" "\\1\n" bytes
                       "${bytes}")
  set(${result} "${bytes}0" PARENT_SCOPE)
endfunction()

# Hexadecimal digits in base 64 [RFC 4648]: three bytes, six digits, become four letters.
function(to_base64 digits result)
  set(letters ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/)
  string(LENGTH ${digits} left)
  set(text "")
  while(left GREATER 0)
    string(SUBSTRING ${digits}000000 0 6 group)
    foreach(shift 18 12 6 0)
      math(EXPR place "(0x${group} >> ${shift}) & 63")
      string(SUBSTRING ${letters} ${place} 1 letter)
      string(APPEND text ${letter})
    endforeach()
    if(left LESS 6) # 2 or 4 digits: two letters or one stand for nothing
      math(EXPR whole "${left} / 2 + 1")
      string(LENGTH "${text}" length)
      math(EXPR kept "${length} - 4 + ${whole}")
      string(SUBSTRING "${text}===" 0 ${kept} text)
      string(SUBSTRING "${text}===" 0 ${length} text)
      break()
    endif()
    string(SUBSTRING ${digits} 6 -1 digits)
    math(EXPR left "${left} - 6")
  endwhile()
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

# Each part uses those before it.
get_filename_component(script_file ${OUTPUT} DIRECTORY)
set(script_file ${script_file}/page_script.js)
file(WRITE ${script_file} "\n")
foreach(part elements axes panel overlay figures)
  file(READ ${folder}/page_${part}.js text)
  file(APPEND ${script_file} "${text}")
endforeach()
read_bytes(${script_file} script)
read_bytes(${folder}/page_style.css style)
file(SHA256 ${script_file} hash)
to_base64(${hash} hash)
file(WRITE ${OUTPUT}
     "/* SPDX-License-Identifier: Apache-2.0 */
/* Script and style sheet of pages, from page_*.js and page_style.css. */
#include \"report/page_internal.h\"

const unsigned char imki_page_script[] = {\n${script}};
const unsigned char imki_page_style[] = {\n${style}};
const char imki_page_script_hash[] = \"sha256-${hash}\";
")
