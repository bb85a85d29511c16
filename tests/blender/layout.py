# SPDX-License-Identifier: Apache-2.0
"""For scripts in a child process: takes the calls of a panel's draw() and keeps the words."""


class Layout:
    def __init__(self, words):
        self.words = words

    def _same(self, *args, **kwargs):
        return Layout(self.words)

    row = column = split = box = _same

    def panel(self, name, **kwargs):
        return Layout(self.words), Layout(self.words)

    def label(self, text="", icon="NONE"):
        self.words.append(text)

    def prop(self, data, name, text=None, **kwargs):
        self.words.append(text or data.bl_rna.properties[name].name)

    def prop_search(self, data, name, *args, **kwargs):
        self.words.append(data.bl_rna.properties[name].name)

    def operator(self, name, text=None, **kwargs):
        self.words.append(text or name)
        return Layout([])

    def operator_menu_enum(self, name, enum, text=None, **kwargs):
        self.words.append(text or name)
        return Layout([])
