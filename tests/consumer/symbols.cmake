# SPDX-License-Identifier: Apache-2.0
# cmake -DLIBRARY=<libltmd.so> -DNAMESPACE=<v0> -P symbols.cmake
# The library shows nothing but its own namespace; above all nothing of OpenEXR, which a host such as Blender
# has loaded in another version.
execute_process(COMMAND nm -D --defined-only --demangle ${LIBRARY}
  OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(STRIP "${symbols}" symbols)
string(REPLACE ";" "," symbols "${symbols}")
string(REPLACE "\n" ";" symbols "${symbols}")
list(LENGTH symbols count)
# A function template's name starts with its result.
list(FILTER symbols EXCLUDE REGEX "^[0-9a-f]+ [A-Za-z] ((void|float|double) )?(typeinfo for |typeinfo name for |vtable for )?ltmd::${NAMESPACE}::")
if(symbols)
  list(JOIN symbols "\n" text)
  message(FATAL_ERROR "${LIBRARY} shows symbols that are not ltmd::${NAMESPACE}:\n${text}")
endif()
if(count LESS 20)
  message(FATAL_ERROR "${LIBRARY} shows only ${count} symbols: its users could not link")
endif()
message(STATUS "${count} symbols, all of ltmd::${NAMESPACE}")
