# Writes the ```cpp blocks of a page to folder/1.cpp, folder/2.cpp, …
/^```cpp/ { file = folder "/" ++count ".cpp"; next }
/^```/ { file = "" }
file { print > file }
