"""Maps at the photograph's full resolution; used by `skinnet.inference.decomposer` alone.

`_layers` enlarges the network's maps and adds the photograph's detail, `_detail` finds the pigment
in that detail, `_chromaticity` measures the photograph's colours and their noise, `_colour_table`
gives the colours of skin, and `_pasting` puts the layers of a crop into the photograph.
"""
