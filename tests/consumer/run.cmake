# SPDX-License-Identifier: Apache-2.0
# cmake -DBUILD=<build folder> -DCOMPILER=<C++ compiler> -P run.cmake
# Installs a build, moves the install, builds the client against it by CMake and by pkg-config, and runs both.
set(work ${BUILD}/consumer)
file(REMOVE_RECURSE ${work})

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " line)
    message(FATAL_ERROR "${line}\n${output}\nended with ${result}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect_client folder)
  run(${folder}/client)
  if(NOT output MATCHES "stretched 2 x 1")
    message(FATAL_ERROR "the client said: ${output}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/installed)
file(RENAME ${work}/installed ${work}/moved)
set(prefix ${work}/moved)

run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/cmake -G Ninja -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${COMPILER})
run(${CMAKE_COMMAND} --build ${work}/cmake)
expect_client(${work}/cmake)

# A version with another interface is refused.
file(MAKE_DIRECTORY ${work}/refused)
file(WRITE ${work}/refused/CMakeLists.txt
  "cmake_minimum_required(VERSION 3.25)\nproject(refused NONE)\nfind_package(ltmd 0.0.9 CONFIG QUIET)\n"
  "if(ltmd_FOUND)\n  message(FATAL_ERROR \"version 0.0 is taken to be compatible\")\nendif()\n")
run(${CMAKE_COMMAND} -S ${work}/refused -B ${work}/refused/build -G Ninja -DCMAKE_PREFIX_PATH=${prefix})

find_program(PKG_CONFIG pkg-config)
if(NOT PKG_CONFIG)
  message(FATAL_ERROR "pkg-config was not found")
endif()
file(GLOB_RECURSE description ${prefix}/*/ltmd.pc)
cmake_path(GET description PARENT_PATH folder)
set(ENV{PKG_CONFIG_PATH} ${folder})
run(${PKG_CONFIG} --cflags --libs ltmd)
separate_arguments(flags UNIX_COMMAND "${output}")
run(${PKG_CONFIG} --variable=libdir ltmd)
string(STRIP "${output}" libraries)
file(MAKE_DIRECTORY ${work}/pkg-config)
run(${COMPILER} -std=c++20 ${CMAKE_CURRENT_LIST_DIR}/client.cpp -o ${work}/pkg-config/client ${flags}
  -Wl,-rpath,${libraries})
expect_client(${work}/pkg-config)

# The command that is installed runs, too.
file(GLOB command ${prefix}/bin/ltmd)
if(command)
  run(${command} verify ${work}/pkg-config)
endif()
